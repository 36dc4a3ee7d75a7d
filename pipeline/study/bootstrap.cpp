#include "pipeline/study/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "engine/base/interrupt.h"
#include "engine/base/random.h"

namespace touchtrace::study {
namespace {

constexpr int samples = 2000;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Drawn indices.
using Draw = std::vector<std::size_t>;

Draw all_of(std::size_t count) {
  Draw draw(count);
  std::iota(draw.begin(), draw.end(), std::size_t{0});
  return draw;
}

Draw resampled(std::size_t count, RandomStream& random) {
  Draw draw(count);
  for (auto& index : draw) index = random.below(count);
  return draw;
}

bool is_defined(const RunValues& runs, std::size_t rollout) {
  return std::ranges::none_of(
      runs, [&](const std::vector<double>& values) { return std::isnan(values[rollout]); });
}

/// [clips] Roll-outs of each clip that are defined in all runs.
std::vector<Draw> rollouts_by_clip(const RunValues& a, const RunValues& b,
                                   const std::vector<int>& clip) {
  std::map<int, Draw> rollouts;
  for (std::size_t i = 0; i < clip.size(); ++i)
    if (is_defined(a, i) && is_defined(b, i)) rollouts[clip[i]].push_back(i);
  std::vector<Draw> clips;
  for (auto& [number, indices] : rollouts) clips.push_back(std::move(indices));
  return clips;
}

/// [runs][clips] Sums over roll-outs.
RunValues sums_of(const RunValues& runs, const std::vector<Draw>& clips) {
  RunValues sums;
  for (const auto& values : runs) {
    auto& row = sums.emplace_back();
    for (const Draw& rollouts : clips)
      row.push_back(std::accumulate(rollouts.begin(), rollouts.end(), 0.0,
                                    [&](double sum, std::size_t i) { return sum + values[i]; }));
  }
  return sums;
}

/// Ratio of the half width of Student's 95 % interval of a mean to that of bootstrap samples:
/// sqrt(n / (n - 1)) t(0.975, n - 1) / 1.96, t by the expansion 26.7.5 of Abramowitz and Stegun
/// (error below 1 % from 3 degrees of freedom on). (Hesterberg, What teachers should know about the
/// bootstrap, 2015.) Samples of two clips have three values, their middle 95 % ends at the clips:
/// t times the standard error from the mean.
double small_sample_factor(std::size_t clips) {
  constexpr double exact[] = {12.706, 4.303};  // t of 1 and 2 degrees of freedom
  const double z = 1.959964, degrees = static_cast<double>(clips - 1), z2 = z * z;
  const double t = clips <= 3
                       ? exact[clips - 2]
                       : z + z * (z2 + 1.0) / (4.0 * degrees) +
                             z * (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / (96.0 * degrees * degrees) +
                             z * (3.0 * z2 * z2 * z2 + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) /
                                 (384.0 * degrees * degrees * degrees);
  return clips == 2 ? t : std::sqrt(1.0 + 1.0 / degrees) * t / z;
}

double mean_of(const RunValues& sums, const Draw& runs, const std::vector<Draw>& clips,
               const Draw& drawn_clips) {
  double sum = 0.0, count = 0.0;
  for (const std::size_t clip : drawn_clips) {
    count += static_cast<double>(clips[clip].size());
    for (const std::size_t run : runs) sum += sums[run][clip] / static_cast<double>(runs.size());
  }
  return sum / count;
}

}  // namespace

Interval bootstrap_difference(const RunValues& a, const RunValues& b, const std::vector<int>& clip,
                              std::uint64_t seed) {
  const auto clips = rollouts_by_clip(a, b, clip);
  if (clips.empty() || a.empty() || b.empty()) return {not_a_number, not_a_number, not_a_number};
  const RunValues sums_a = sums_of(a, clips), sums_b = sums_of(b, clips);
  const Draw all = all_of(clips.size());
  const double mean =
      mean_of(sums_a, all_of(a.size()), clips, all) - mean_of(sums_b, all_of(b.size()), clips, all);
  if (clips.size() < 2) return {mean, not_a_number, not_a_number};
  RandomStream random(seed, "bootstrap");
  std::vector<double> means(samples);
  for (double& sample : means) {
    throw_if_interrupted();
    const Draw drawn = resampled(clips.size(), random);
    sample = mean_of(sums_a, resampled(a.size(), random), clips, drawn) -
             mean_of(sums_b, resampled(b.size(), random), clips, drawn);
  }
  std::ranges::sort(means);
  const double factor = small_sample_factor(clips.size());
  return {mean, mean + factor * (means[samples / 40] - mean),
          mean + factor * (means[samples - 1 - samples / 40] - mean)};
}

Interval bootstrap_mean(const RunValues& values, const std::vector<int>& clip, std::uint64_t seed) {
  return bootstrap_difference(values, {std::vector<double>(clip.size(), 0.0)}, clip, seed);
}

}  // namespace touchtrace::study
