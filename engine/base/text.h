#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// The name nearest to `wrong` by edit distance, or empty if none is near enough to suggest.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// "a, b, c"
std::string comma_separated(const std::vector<std::string>& names);

/// The parts of a text between `separator`s, those that are empty too.
std::vector<std::string> separated(std::string_view text, char separator);

/// "did you mean 'x'? known: ..." for an unknown name.
std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace touchtrace
