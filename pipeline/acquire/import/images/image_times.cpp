#include "pipeline/acquire/import/images/image_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/images/named_images.h"
#include "pipeline/acquire/stamp_unit.h"
#include "pipeline/acquire/table_columns.h"
#include "pipeline/acquire/time_order.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_images = 10'000'000;

std::optional<fs::path> find_list(const fs::path& folder) {
  for (const fs::path& where : {folder, folder.parent_path()})
    for (const char* name : {"times.txt", "timestamps.txt", "times.csv", "timestamps.csv"})
      if (fs::is_regular_file(where / name)) return where / name;
  return std::nullopt;
}

/// Times of all frames in the metadata.json of a Record3D export; empty: none.
std::vector<double> record3d_times(const fs::path& folder) {
  constexpr std::size_t max_bytes = 64u << 20;
  for (const fs::path& where : {folder, folder.parent_path()}) {
    const fs::path file = where / "metadata.json";
    if (!fs::is_regular_file(file)) continue;
    const auto document = nlohmann::json::parse(read_file(file, max_bytes), nullptr, false);
    if (!document.is_object() || !document.contains("frameTimestamps")) continue;
    const auto& stamps = document["frameTimestamps"];
    if (stamps.is_array() &&
        std::ranges::all_of(stamps, [](const auto& stamp) { return stamp.is_number(); }))
      return stamps.get<std::vector<double>>();
  }
  return {};
}

/// Times of the frames that the images' names number, or of all in order; nullopt: they do not fit.
std::optional<std::vector<double>> record3d_times(const fs::path& folder,
                                                  const NamedImages& images) {
  const auto all_s = record3d_times(folder);
  if (all_s.empty() || (images.numbers.empty() && all_s.size() != images.files.size()))
    return std::nullopt;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < images.files.size(); ++i) {
    const double frame = images.numbers.empty() ? static_cast<double>(i) : images.numbers[i];
    if (!(frame >= 0.0 && frame < static_cast<double>(all_s.size()))) return std::nullopt;
    times_s.push_back(all_s[static_cast<std::size_t>(frame)]);
  }
  return times_s;
}

/// Column of times: by name, else the first one with a number.
TableColumn time_column(const TextTable& table) {
  if (const auto named =
          find_column(table, table.names(), {"time", "t", "timestamp", "stamp"}, time_units()))
    return *named;
  for (std::size_t i = 0; i < table.fields().size(); ++i)
    if (parse_number<double>(table.fields()[i], table.has_decimal_comma())) return {i, 1.0, "time"};
  throw LineFault{"no number"};
}

/// Whether the first column of a list without names counts its lines, and the second increases as
/// times do.
bool has_times_behind_numbers(const std::vector<double>& first, const std::vector<double>& second) {
  const auto counts = [](double a, double b) { return b - a != 1.0; };
  return first.size() > 1 && second.size() == first.size() &&
         std::ranges::adjacent_find(first, counts) == first.end() &&
         std::ranges::adjacent_find(second, std::greater_equal()) == second.end();
}

std::vector<double> read_times(const fs::path& list) {
  TextTable table(list);
  std::optional<TableColumn> column;
  std::vector<double> times_s, second;
  for_each_row(table, max_images, "give one line per image, its time in seconds first", [&] {
    if (!column) column = time_column(table);
    const double time_s = value_of<double>(table, *column);
    if (!(time_s >= 0.0)) throw LineFault{"the time is missing or negative"};
    times_s.push_back(time_s);
    if (!table.names().empty() || column->index != 0 || table.num_columns() < 2) return;
    if (const auto next = parse_number<double>(table.fields()[1], table.has_decimal_comma()))
      second.push_back(*next);
  });
  const bool has_numbers = has_times_behind_numbers(times_s, second);
  return in_seconds(std::move(has_numbers ? second : times_s), list.string());
}

std::vector<double> listed_times(const fs::path& list, std::size_t num_images,
                                 const fs::path& folder) {
  auto times_s = read_times(list);
  if (times_s.size() != num_images)
    throw data_error(fmt::format("{} has {} times, {} has {} images", list.string(), times_s.size(),
                                 folder.string(), num_images),
                     "give one time per image, or one list in each folder");
  return times_s;
}

/// What to do for times of images in a folder.
std::string times_hint(const fs::path& folder) {
  for (const char* name : {"associations.txt", "associate.txt", "associated.txt"})
    if (const fs::path list = folder.parent_path() / name; fs::is_regular_file(list))
      return fmt::format(
          "split {0}, which is not read, into the lists of a TUM folder: in {1}, "
          "`awk '{{print $1, $2}}' {2} > rgb.txt; awk '{{print $3, $4}}' {2} > depth.txt`",
          list.string(), folder.parent_path().string(), name);
  return "give --rate HZ, a file times.txt with one time per image, or file names that are time "
         "stamps";
}

/// Times in the names. Whole seconds give way to a rate: "20240101_000012" may be frame 12.
bool has_named_times(const NamedImages& images, double rate_hz) {
  return !images.stamps.empty() && !(images.has_whole_seconds && rate_hz > 0.0);
}

std::vector<double> named_times(const fs::path& folder, const NamedImages& images, double rate_hz) {
  if (images.has_dates)
    Progress::report(fmt::format("{}: times are the dates in the file names", folder.string()));
  if (rate_hz > 0.0)
    Progress::warn(fmt::format("--rate is not used: file names in {} have times", folder.string()));
  return in_seconds(images.stamps, folder.string());
}

std::vector<double> image_times(const fs::path& folder, const NamedImages& images, double rate_hz) {
  if (has_named_times(images, rate_hz)) return named_times(folder, images, rate_hz);
  if (images.numbers_disagree)
    Progress::warn(fmt::format(
        "{}: several numbers differ between the file names. The first ones order the images, and "
        "none counts frames",
        folder.string()));
  if (const auto list = find_list(folder)) return listed_times(*list, images.files.size(), folder);
  if (auto times_s = record3d_times(folder, images)) return *std::move(times_s);
  if (rate_hz <= 0.0)
    throw data_error(fmt::format("the images in {} have no times", folder.string()),
                     times_hint(folder));
  std::vector<double> times_s;
  for (std::size_t i = 0; i < images.files.size(); ++i)
    times_s.push_back((images.numbers.empty() ? static_cast<double>(i) : images.numbers[i]) /
                      rate_hz);
  return times_s;
}

}  // namespace

std::vector<StampedFile> stamped_images(const fs::path& folder, std::vector<fs::path> images,
                                        double rate_hz) {
  const NamedImages named = order_by_name(std::move(images));
  const auto times_s = image_times(folder, named, rate_hz);
  std::vector<StampedFile> files;
  for (std::size_t i = 0; i < times_s.size(); ++i) files.push_back({times_s[i], named.files[i]});
  return in_time_order(std::move(files), &StampedFile::time_s, folder.string());
}

}  // namespace touchtrace
