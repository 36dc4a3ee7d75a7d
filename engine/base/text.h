#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Shortest name that begins with `wrong`, else the one with the smallest edit distance; empty if
/// none is near enough to suggest.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// Letters of ASCII in lower case.
std::string lower_case(std::string_view text);

/// "a, b, c"
std::string comma_separated(const std::vector<std::string>& names);

/// Splits a text at every `separator`; keeps empty parts.
std::vector<std::string> split_text(std::string_view text, char separator);

/// Parses a number that fills the whole text. Returns false, and leaves `number` as it is,
/// otherwise.
template <class Number>
bool parse_whole(std::string_view text, Number& number) {
  Number parsed{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, parsed);
  if (error != std::errc() || stop != end) return false;
  number = parsed;
  return true;
}

/// "; did you mean 'x'?", or empty if no name is near enough.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

/// "did you mean 'x'? known: a, b, x", without the question if no name is near.
std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace touchtrace
