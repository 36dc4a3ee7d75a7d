#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace {
namespace {

using Sums = std::array<double, state_size>;

/// Adds what `term` gives for every trusted training label; returns how many there were.
template <class Term>
std::size_t sum_over_training(const Dataset& dataset, Sums& sums, Term term) {
  std::size_t count = 0;
  for (const auto& sequence : dataset.sequences) {
    if (sequence.split != Split::train) continue;
    for (int frame = sequence.first_frame; frame < sequence.first_frame + sequence.frames;
         ++frame) {
      if (!dataset.trusted[frame]) continue;
      ++count;
      for (int d = 0; d < state_size; ++d) sums[d] += term(d, dataset.label[frame][d]);
    }
  }
  return count;
}

}  // namespace

Normalization fit_normalization(const Dataset& dataset) {
  Sums mean{}, square{};
  const auto count = sum_over_training(dataset, mean, [](int, double value) { return value; });
  if (count == 0)
    throw data_error("no training clip has a label that can be trusted",
                     "label again with another tracker or better boxes, or record more clips");
  for (double& value : mean) value /= static_cast<double>(count);
  sum_over_training(dataset, square,
                    [&](int d, double value) { return (value - mean[d]) * (value - mean[d]); });
  Normalization scaling;
  for (int d = 0; d < state_size; ++d) {
    scaling.mean[d] = static_cast<float>(mean[d]);
    scaling.deviation[d] = std::max(
        least_deviation, static_cast<float>(std::sqrt(square[d] / static_cast<double>(count))));
  }
  return scaling;
}

State Normalization::scaled(const State& state) const {
  State result;
  for (int d = 0; d < state_size; ++d) result[d] = (state[d] - mean[d]) / deviation[d];
  return result;
}

State Normalization::unscaled(const State& state) const {
  State result;
  for (int d = 0; d < state_size; ++d) result[d] = mean[d] + deviation[d] * state[d];
  return result;
}

}  // namespace touchtrace
