#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Name with the smallest edit distance to `wrong`; empty if none is near enough to suggest.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// "a, b, c"
std::string comma_separated(const std::vector<std::string>& names);

/// Splits a text at every `separator`; keeps empty parts.
std::vector<std::string> split_text(std::string_view text, char separator);

/// "did you mean 'x'? known: a, b, x", without the question if no name is near.
std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace touchtrace
