#include "pipeline/acquire/iso_time.h"

#include <chrono>
#include <regex>
#include <string>

#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_bytes = 40;

/// nullopt if there is no such day.
std::optional<long> days_since_epoch(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
}

}  // namespace

std::optional<double> parse_iso_time(std::string_view text) {
  static const std::regex pattern(
      "(?:([0-9]{4})-([0-9]{2})-([0-9]{2})[T ])?([0-9]{2}):([0-9]{2}):([0-9]{2}(?:[.,][0-9]{1,9})?)"
      "(?:Z|([+-])([0-9]{2}):?([0-9]{2}))?");
  std::match_results<std::string_view::const_iterator> match;
  if (text.size() > max_bytes || !std::regex_match(text.begin(), text.end(), match, pattern))
    return std::nullopt;
  const auto number = [&](std::size_t group) { return std::stoi(match[group].str()); };
  const auto days =
      match[1].matched ? days_since_epoch(number(1), number(2), number(3)) : std::optional<long>(0);
  if (!days) return std::nullopt;
  std::string seconds = match[6].str();
  if (seconds.size() > 2) seconds[2] = '.';
  double time_s = 0.0;
  parse_whole(seconds, time_s);
  time_s += 86400.0 * static_cast<double>(*days) + 3600.0 * number(4) + 60.0 * number(5);
  if (match[7].matched)
    time_s -= (match[7].str() == "-" ? -1.0 : 1.0) * (3600.0 * number(8) + 60.0 * number(9));
  return time_s;
}

}  // namespace touchtrace
