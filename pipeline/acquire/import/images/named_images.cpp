#include "pipeline/acquire/import/images/named_images.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <regex>
#include <string>

#include "pipeline/acquire/iso_time.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t min_stamp_digits = 13;
constexpr int first_year = 1990, last_year = 2100;

/// Numbers in a name, and its date.
struct ParsedName {
  fs::path file;
  std::vector<std::string> numbers;
  std::optional<double> date_s;  ///< since 1970
  std::size_t fraction_digits = 0;

  double number(std::size_t i) const { return std::stod(numbers[i]); }
};

/// "2026-03-04_10-15-07_313", "20260304T101507.313" and the like: with milliseconds, microseconds,
/// nanoseconds or none.
void parse_date(const std::string& stem, ParsedName& name) {
  static const std::regex pattern(
      "(?:^|[^0-9])([0-9]{4})[-_.]?([0-9]{2})[-_.]?([0-9]{2})[-_ T.]?([0-9]{2})[-_:.h]?([0-9]{2})"
      "[-_:.m]?([0-9]{2})(?:[-_.,s]?([0-9]{9}|[0-9]{6}|[0-9]{3}))?(?![0-9])");
  std::smatch match;
  if (!std::regex_search(stem, match, pattern)) return;
  const auto number = [&](std::size_t group) { return std::stoi(match[group]); };
  if (number(1) < first_year || number(1) > last_year || number(4) > 23 || number(5) > 59 ||
      number(6) > 60)
    return;
  const std::string fraction = match[7].matched ? "." + match[7].str() : "";
  name.date_s = parse_iso_time(fmt::format("{}-{}-{}T{}:{}:{}{}", match[1].str(), match[2].str(),
                                           match[3].str(), match[4].str(), match[5].str(),
                                           match[6].str(), fraction));
  name.fraction_digits = static_cast<std::size_t>(match[7].length());
}

ParsedName parse(const fs::path& file) {
  static const std::regex number("[0-9]+(\\.[0-9]+)?");
  const std::string stem = file.stem();
  ParsedName name{file, {}, {}};
  for (std::sregex_iterator match(stem.begin(), stem.end(), number), end; match != end; ++match)
    name.numbers.push_back(match->str());
  parse_date(stem, name);
  return name;
}

/// Whether all names have dates of one format and no two are equal.
bool have_dates(const std::vector<ParsedName>& names) {
  std::vector<double> times_s;
  for (const ParsedName& name : names) {
    if (!name.date_s || name.fraction_digits != names.front().fraction_digits) return false;
    times_s.push_back(*name.date_s);
  }
  std::ranges::sort(times_s);
  return std::ranges::adjacent_find(times_s) == times_s.end();
}

/// Indices of the numbers that differ between the names, or the last one if none does; empty if
/// names have different numbers of them, or none.
std::vector<std::size_t> varying_numbers(const std::vector<ParsedName>& names) {
  const std::size_t count = names.front().numbers.size();
  std::vector<std::size_t> varying;
  if (std::ranges::any_of(names, [&](const auto& name) { return name.numbers.size() != count; }))
    return {};
  for (std::size_t i = 0; i < count; ++i)
    if (std::ranges::any_of(
            names, [&](const auto& name) { return name.numbers[i] != names.front().numbers[i]; }))
      varying.push_back(i);
  if (varying.empty() && count > 0) varying.push_back(count - 1);
  return varying;
}

bool is_stamp(const std::string& number) {
  return number.find('.') != std::string::npos || number.size() >= min_stamp_digits;
}

void sort_by_numbers(std::vector<ParsedName>& names, const std::vector<std::size_t>& varying) {
  std::ranges::sort(names, [&](const ParsedName& a, const ParsedName& b) {
    for (const std::size_t i : varying)
      if (a.number(i) != b.number(i)) return a.number(i) < b.number(i);
    return a.file.filename() < b.file.filename();
  });
}

/// Last number of each name; of names that have different numbers of them, too.
void use_last_numbers(std::vector<ParsedName>& names) {
  for (ParsedName& name : names) name.numbers = {name.numbers.empty() ? "0" : name.numbers.back()};
}

/// Sorts by dates; returns all but the files.
NamedImages sort_by_dates(std::vector<ParsedName>& names) {
  NamedImages images;
  images.has_dates = true;
  images.has_whole_seconds = names.front().fraction_digits == 0;
  std::ranges::sort(names, {}, &ParsedName::date_s);
  for (const ParsedName& name : names) images.stamps.push_back(*name.date_s);
  return images;
}

/// Sorts by numbers; returns all but the files.
NamedImages sort_by_numbers(std::vector<ParsedName>& names) {
  NamedImages images;
  const bool has_numbers =
      std::ranges::any_of(names, [](const ParsedName& name) { return !name.numbers.empty(); });
  std::vector<std::size_t> varying = varying_numbers(names);
  if (varying.empty()) use_last_numbers(names), varying = {0};
  sort_by_numbers(names, varying);
  const std::size_t last = varying.back();
  const auto value = [&](const ParsedName& name) { return name.number(last); };
  images.numbers_disagree = !std::ranges::is_sorted(names, {}, value);
  if (!has_numbers || images.numbers_disagree) return images;
  const bool are_stamps = std::ranges::all_of(
      names, [&](const ParsedName& name) { return is_stamp(name.numbers[last]); });
  for (const ParsedName& name : names)
    (are_stamps ? images.stamps : images.numbers).push_back(value(name));
  return images;
}

}  // namespace

NamedImages order_by_name(std::vector<fs::path> files) {
  if (files.empty()) return {};
  std::vector<ParsedName> names;
  for (const fs::path& file : files) names.push_back(parse(file));
  NamedImages images = have_dates(names) ? sort_by_dates(names) : sort_by_numbers(names);
  for (ParsedName& name : names) images.files.push_back(std::move(name.file));
  return images;
}

}  // namespace touchtrace
