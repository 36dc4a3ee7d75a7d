#include "pipeline/acquire/import/images/frame_numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/acquire/import/images/named_images.h"
#include "pipeline/acquire/stamp_unit.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr std::uint64_t max_counted_frames = 10'000'000;
constexpr double min_stamp_step = 10.0;  // of numbers that may be times
constexpr double min_image_rate_hz = 1.0;

using Numbers = std::vector<std::uint64_t>;

Numbers steps_of(const Numbers& numbers) {
  Numbers steps;
  for (std::size_t i = 1; i < numbers.size(); ++i) steps.push_back(numbers[i] - numbers[i - 1]);
  return steps;
}

std::string range_of(const Numbers& numbers) {
  return fmt::format("{} to {}", numbers.front(), numbers.back());
}

/// Whether the times of all images are their numbers over the rate.
bool has_numbered_times(const SourceStream& stream, double rate_hz) {
  if (stream.frame_numbers.empty() || rate_hz <= 0.0) return false;
  for (std::size_t i = 0; i < stream.images.size(); ++i) {
    const double time_s = static_cast<double>(stream.frame_numbers[i]) / rate_hz;
    if (std::abs(stream.images[i].host_time_s - time_s) > 1e-6 * (1.0 + time_s)) return false;
  }
  return true;
}

std::size_t num_missing(const Numbers& numbers, const Numbers& in) {
  Numbers missing;
  std::ranges::set_difference(numbers, in, std::back_inserter(missing));
  return missing.size();
}

void warn_of_different_numbers(const Numbers& color, const Numbers& depth) {
  const std::size_t num_color = num_missing(color, depth), num_depth = num_missing(depth, color);
  if (num_color + num_depth == 0) return;
  Progress::warn(fmt::format(
      "{} of {} colour images have no depth image of their number, {} of {} depth images no colour "
      "image: numbers {} and {}. Equal numbers are paired; rename the files of one folder if "
      "others belong together",
      num_color, color.size(), num_depth, depth.size(), range_of(color), range_of(depth)));
}

/// Warns of numbers that increase by much more than 1, and unevenly or as milliseconds would at
/// this rate.
void warn_of_stamps(const Numbers& numbers, const char* kind, double rate_hz) {
  Numbers steps = steps_of(numbers);
  if (steps.empty()) return;
  const double step = median({steps.begin(), steps.end()});
  const double ms_per_step_at_rate = 1e3 / rate_hz;
  const bool is_uneven = frame_counter(numbers).empty();
  const bool fits_ms = std::abs(step - ms_per_step_at_rate) < 0.1 * ms_per_step_at_rate;
  if (step < min_stamp_step || !(is_uneven || fits_ms)) return;
  const auto unit = stamp_unit({numbers.begin(), numbers.end()}, min_image_rate_hz);
  Progress::warn(fmt::format(
      "the numbers in the names of the {} images increase by {:g}{}. They were taken as numbers of "
      "frames at {:g} Hz; if they are times, list them in times.txt, one per line, without --rate",
      kind, step,
      unit ? fmt::format(", as times in {} do at {:.3g} Hz", unit->name, unit->per_second / step)
           : "",
      rate_hz));
}

}  // namespace

std::vector<std::uint64_t> frame_numbers(const std::vector<StampedFile>& files) {
  std::vector<std::filesystem::path> paths;
  for (const StampedFile& file : files) paths.push_back(file.path);
  const NamedImages named = order_by_name(paths);
  if (named.files != paths) return {};
  Numbers numbers;
  for (const double number : named.numbers) {
    numbers.push_back(static_cast<std::uint64_t>(number));
    if (numbers.size() > 1 && numbers.back() <= numbers[numbers.size() - 2]) return {};
  }
  return numbers;
}

std::vector<std::uint64_t> frame_counter(const std::vector<std::uint64_t>& numbers) {
  const Numbers steps = steps_of(numbers);
  const std::uint64_t step = std::accumulate(steps.begin(), steps.end(), std::uint64_t{0},
                                             std::gcd<std::uint64_t, std::uint64_t>);
  if (step == 0 || 2 * static_cast<std::size_t>(std::ranges::count(steps, step)) < steps.size() ||
      (numbers.back() - numbers.front()) / step > max_counted_frames)
    return {};
  Numbers counter;
  for (const std::uint64_t number : numbers) counter.push_back(number / step);
  return counter;
}

void check_numbers(const ImportSource& source, double rate_hz) {
  const auto &color = source.color, &depth = source.depth;
  if (has_numbered_times(color, rate_hz)) warn_of_stamps(color.frame_numbers, "colour", rate_hz);
  if (has_numbered_times(depth, rate_hz)) warn_of_stamps(depth.frame_numbers, "depth", rate_hz);
  if (has_numbered_times(color, rate_hz) && has_numbered_times(depth, rate_hz))
    warn_of_different_numbers(color.frame_numbers, depth.frame_numbers);
}

void require_pairs(const ImportSource& source) {
  const auto color_s = host_times_s(source.color), depth_s = host_times_s(source.depth);
  if (color_s.empty() || depth_s.empty() || !pair_frames(color_s, depth_s).empty()) return;
  const Numbers &color = source.color.frame_numbers, &depth = source.depth.frame_numbers;
  const std::string numbers =
      color.empty() || depth.empty()
          ? ""
          : fmt::format("; numbers {} and {}", range_of(color), range_of(depth));
  throw data_error(
      fmt::format(
          "no depth image has a colour image at its time: colour images are from {:.3f} s to "
          "{:.3f} s, depth images from {:.3f} s to {:.3f} s{}",
          color_s.front(), color_s.back(), depth_s.front(), depth_s.back(), numbers),
      "give images of one time the same number, or times on the same clock");
}

}  // namespace touchtrace
