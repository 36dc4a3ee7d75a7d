#include "pipeline/acquire/time_order.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_mixed_images = 3;  // on both sides of a backward step
constexpr double max_clock_steps = 0.1;      // per image; a list in any order has more

void require_finite_times(const std::vector<double>& time_s, const std::string& source) {
  const auto bad = std::ranges::find_if_not(time_s, [](double t) { return std::isfinite(t); });
  if (bad != time_s.end())
    throw data_error(
        fmt::format("{}: image {} has the time {}", source, bad - time_s.begin() + 1, *bad),
        "give each image a time");
}

/// Images that run backward from the one before.
std::vector<std::size_t> backward_steps(const std::vector<double>& time_s) {
  std::vector<std::size_t> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] < time_s[i - 1]) steps.push_back(i);
  return steps;
}

/// Whether sorting would move several images from before step `i` behind several from after it. A
/// single late image moves alone.
bool is_clock_step(const std::vector<double>& time_s, std::size_t i) {
  std::size_t later = 1, earlier = 1;
  while (later < i && time_s[i - later - 1] <= time_s[i - later] &&
         time_s[i - later - 1] > time_s[i])
    ++later;
  while (i + earlier < time_s.size() && time_s[i + earlier] >= time_s[i + earlier - 1] &&
         time_s[i + earlier] < time_s[i - 1])
    ++earlier;
  return std::min(later, earlier) >= min_mixed_images;
}

/// Reports the steps or rejects them.
void judge_steps(const std::vector<double>& time_s, const std::vector<std::size_t>& steps,
                 const std::string& source) {
  const auto is_step = [&](std::size_t i) { return is_clock_step(time_s, i); };
  const bool is_rare =
      static_cast<double>(steps.size()) <= max_clock_steps * static_cast<double>(time_s.size());
  const auto clock_step = std::ranges::find_if(steps, is_step);
  const bool is_set_back = is_rare && clock_step != steps.end();
  const std::size_t first = is_set_back ? *clock_step : steps.front();
  const std::string fault = fmt::format(
      "{}: the times of {} of {} images run backward, {} image {}: {:.3f} s after {:.3f} s", source,
      steps.size(), time_s.size(), is_set_back ? "the clock was set back before" : "first of",
      first + 1, time_s[first], time_s[first - 1]);
  if (is_set_back)
    throw data_error(fault,
                     "correct the times, or import the images before and after it as two "
                     "recordings; if the order of the images means nothing, sort them by time");
  Progress::warn(fault + "; images are sorted by time");
}

}  // namespace

std::vector<std::size_t> time_order(const std::vector<double>& time_s, const std::string& source) {
  require_finite_times(time_s, source);
  if (const auto steps = backward_steps(time_s); !steps.empty()) judge_steps(time_s, steps, source);
  std::vector<std::size_t> order(time_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return time_s[i]; });
  return order;
}

}  // namespace touchtrace
