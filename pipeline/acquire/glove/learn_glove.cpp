#include "pipeline/acquire/glove/learn_glove.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_frames = 20;
constexpr double min_noise_counts = 0.5;  // of the converter's rounding
constexpr double response_sigmas = 6.0;   // change that noise does not explain
constexpr double min_polarity_ratio = 2.0, max_dead_fraction = 0.5;
// Quantiles of a taxel's counts: when the glove is squeezed, and when it is touched now and then.
constexpr double squeezed_part = 0.95, touched_part = 0.995;
constexpr double max_repeated_frames = 0.1, max_noise_fraction = 0.05;

/// Counts of one taxel, sorted.
std::vector<double> sorted_counts(const std::vector<std::uint16_t>& frames, std::size_t taxels,
                                  std::size_t taxel) {
  std::vector<double> counts;
  for (std::size_t i = taxel; i < frames.size(); i += taxels) counts.push_back(frames[i]);
  std::ranges::sort(counts);
  return counts;
}

double noise_of(std::vector<double> counts, double baseline) {
  for (double& count : counts) count -= baseline;
  return std::max(min_noise_counts, robust_sigma(std::move(counts)));
}

double repeated_fraction(const std::vector<std::uint16_t>& frames, std::size_t taxels) {
  std::size_t repeated = 0;
  for (std::size_t at = taxels; at < frames.size(); at += taxels)
    repeated += std::equal(frames.begin() + static_cast<std::ptrdiff_t>(at),
                           frames.begin() + static_cast<std::ptrdiff_t>(at + taxels),
                           frames.begin() + static_cast<std::ptrdiff_t>(at - taxels));
  return static_cast<double>(repeated) * static_cast<double>(taxels) /
         static_cast<double>(frames.size());
}

void require_frames(const std::vector<std::uint16_t>& frames, std::size_t taxels,
                    const char* state) {
  if (frames.size() >= min_frames * taxels) return;
  throw data_error(fmt::format("{} frames of the glove {}", frames.size() / taxels, state),
                   fmt::format("at least {} are needed: give more --seconds", min_frames));
}

/// Changes of a taxel from rest to quantiles when it is squeezed, without noise.
struct Response {
  double up, down;
};

Response response_of(const std::vector<double>& squeezed, double baseline, double noise,
                     double probability) {
  const auto beyond_noise = [&](double change) {
    return change > response_sigmas * noise ? change : 0.0;
  };
  return {beyond_noise(quantile(squeezed, probability) - baseline),
          beyond_noise(baseline - quantile(squeezed, 1.0 - probability))};
}

/// Sum over the taxels of a glove that is touched now and then.
Response seldom_response(const std::vector<std::uint16_t>& frames,
                         const std::vector<double>& baselines, const std::vector<double>& noises) {
  Response all{0.0, 0.0};
  for (std::size_t taxel = 0; taxel < baselines.size(); ++taxel) {
    const Response response = response_of(sorted_counts(frames, baselines.size(), taxel),
                                          baselines[taxel], noises[taxel], touched_part);
    all.up += response.up, all.down += response.down;
  }
  return all;
}

}  // namespace

LearnedGlove learn_glove(const GloveInfo& info, const std::vector<std::uint16_t>& rest,
                         const std::vector<std::uint16_t>& squeezed) {
  const auto taxels = static_cast<std::size_t>(info.taxels());
  const double max_count = (1 << info.bits) - 1;
  require_frames(rest, taxels, "at rest"), require_frames(squeezed, taxels, "being squeezed");
  LearnedGlove glove;
  glove.taxels = info.taxels();
  std::vector<double> baselines, noises;
  Response all{0.0, 0.0};
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const auto at_rest = sorted_counts(rest, taxels, taxel),
               pressed = sorted_counts(squeezed, taxels, taxel);
    baselines.push_back(median(at_rest));
    noises.push_back(noise_of(at_rest, baselines.back()));
    const Response response = response_of(pressed, baselines.back(), noises.back(), squeezed_part);
    all.up += response.up, all.down += response.down;
    glove.dead_taxels += response.up + response.down == 0.0;
    const double lowest = std::min(at_rest.front(), pressed.front()),
                 highest = std::max(at_rest.back(), pressed.back());
    glove.stuck_taxels += lowest == highest && (lowest == 0.0 || lowest == max_count);
  }
  if (all.up + all.down == 0.0) all = seldom_response(squeezed, baselines, noises);
  glove.polarity = all.up >= all.down ? 1 : -1;
  glove.polarity_ratio = std::max(all.up, all.down) / std::max(1.0, std::min(all.up, all.down));
  glove.baseline_counts.assign(baselines.begin(), baselines.end());
  glove.median_baseline = median(std::move(baselines));
  glove.noise_counts = median(std::move(noises));
  glove.repeated_frames =
      std::max(repeated_fraction(rest, taxels), repeated_fraction(squeezed, taxels));
  glove.is_noisy = glove.noise_counts > max_noise_fraction * max_count;
  return glove;
}

std::vector<std::string> LearnedGlove::faults() const {
  std::vector<std::string> faults;
  if (dead_taxels > max_dead_fraction * taxels)
    faults.push_back(fmt::format("{} of {} taxels do not respond", dead_taxels, taxels));
  if (polarity_ratio < min_polarity_ratio)
    faults.push_back(
        fmt::format("the polarity is not clear: counts change {:.1f} times as much in "
                    "one direction as in the other",
                    polarity_ratio));
  if (repeated_frames > max_repeated_frames)
    faults.push_back(
        fmt::format("{:.0f} % of the frames repeat the previous one", 100.0 * repeated_frames));
  if (is_noisy)
    faults.push_back(fmt::format("the noise of {:.1f} counts is more than {:.0f} % of the range",
                                 noise_counts, 100.0 * max_noise_fraction));
  return faults;
}

nlohmann::json to_json(const LearnedGlove& glove) {
  return {{"polarity", glove.polarity},
          {"polarity_ratio", glove.polarity_ratio},
          {"baseline_counts", glove.baseline_counts},
          {"median_baseline", glove.median_baseline},
          {"noise_counts", glove.noise_counts},
          {"taxels", glove.taxels},
          {"dead_taxels", glove.dead_taxels},
          {"stuck_taxels", glove.stuck_taxels},
          {"repeated_frames", glove.repeated_frames},
          {"faults", glove.faults()}};
}

}  // namespace touchtrace
