#include "pipeline/study/band.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {
namespace {

double factor_at(const BandScale& scale, int step) {
  if (scale.empty()) return 1.0;
  return scale[std::min<std::size_t>(static_cast<std::size_t>(step), scale.size() - 1)];
}

/// |target - state| / spread of each trusted value of a step.
std::vector<double> ratios_of_step(const Rollout& rollout, const RolloutBatch& batch, int step) {
  std::vector<double> ratios;
  for (int s = 0; s < batch.sequences; ++s) {
    const std::size_t row = static_cast<std::size_t>(s) * batch.steps + step;
    if (!batch.weight.empty() && batch.weight[row] <= 0.0f) continue;
    for (std::size_t i = row * state_size; i < (row + 1) * state_size; ++i)
      ratios.push_back(std::abs(static_cast<double>(batch.target[i]) - rollout.state[i]) /
                       std::max<double>(rollout.spread[i], min_spread));
  }
  return ratios;
}

}  // namespace

BandScale fit_band_scale(const Rollout& rollout, const RolloutBatch& batch, double coverage) {
  BandScale scale(static_cast<std::size_t>(batch.steps), 1.0);
  for (int step = 0; step < batch.steps; ++step) {
    auto ratios = ratios_of_step(rollout, batch, step);
    if (ratios.empty()) continue;
    const double rank = std::ceil(coverage * (static_cast<double>(ratios.size()) + 1.0));
    const auto place = std::min(static_cast<std::size_t>(rank), ratios.size()) - 1;
    std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(place),
                     ratios.end());
    scale[step] = std::max(ratios[place], min_scale);
  }
  return scale;
}

std::vector<double> coverage_by_step(const Rollout& rollout, const RolloutBatch& batch,
                                     const BandScale& scale) {
  std::vector<double> coverage;
  for (int step = 0; step < batch.steps; ++step) {
    const auto ratios = ratios_of_step(rollout, batch, step);
    const double factor = factor_at(scale, step);
    const auto inside =
        std::ranges::count_if(ratios, [&](double ratio) { return ratio <= factor; });
    coverage.push_back(ratios.empty()
                           ? std::numeric_limits<double>::quiet_NaN()
                           : static_cast<double>(inside) / static_cast<double>(ratios.size()));
  }
  return coverage;
}

float scaled_spread(const BandScale& scale, int step, float spread) {
  return static_cast<float>(factor_at(scale, step) * std::max<double>(spread, min_spread));
}

Rollout with_scaled_band(Rollout rollout, int steps, const BandScale& scale) {
  for (std::size_t i = 0; i < rollout.spread.size(); ++i)
    rollout.spread[i] =
        scaled_spread(scale, static_cast<int>(i / state_size) % steps, rollout.spread[i]);
  return rollout;
}

}  // namespace touchtrace::study
