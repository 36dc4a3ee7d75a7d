#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace {
namespace {

using Sums = std::array<double, state_size>;

constexpr std::array position_dimensions{0, 1, 2, 6, 7, 8};  ///< of State

/// Adds term(d, value) of every trusted training label to sums[d]; returns the number of labels.
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

double position_spread_m(const Normalization& scaling) {
  double variance = 0.0;
  for (const int d : position_dimensions) variance += scaling.sigma[d] * scaling.sigma[d];
  return std::sqrt(variance);
}

double position_spread_m(const Dataset& dataset) {
  double variance = 0.0;
  for (const int d : position_dimensions) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (int frame = 0; frame < dataset.frames(); ++frame) {
      if (!dataset.trusted[frame]) continue;
      const double value = dataset.label[frame][d];
      sum += value, squares += value * value, count += 1.0;
    }
    variance += count > 0.0 ? squares / count - sum * sum / (count * count) : 0.0;
  }
  return std::sqrt(std::max(0.0, variance));
}

Normalization fit_normalization(const Dataset& dataset) {
  Sums mean{}, square{};
  const auto count = sum_over_training(dataset, mean, [](int, double value) { return value; });
  if (count == 0)
    throw data_error(
        "no training clip has a label of good quality",
        "`touchtrace check` lists the flags of labels; label again with better boxes, record "
        "more clips, or check that the times of your own labels are the recording's");
  for (double& value : mean) value /= static_cast<double>(count);
  sum_over_training(dataset, square,
                    [&](int d, double value) { return (value - mean[d]) * (value - mean[d]); });
  Normalization result;
  for (int d = 0; d < state_size; ++d) {
    result.mean[d] = static_cast<float>(mean[d]);
    result.sigma[d] =
        std::max(min_sigma, static_cast<float>(std::sqrt(square[d] / static_cast<double>(count))));
  }
  return result;
}

State Normalization::normalize(const State& state) const {
  State result;
  for (int d = 0; d < state_size; ++d) result[d] = (state[d] - mean[d]) / sigma[d];
  return result;
}

State Normalization::denormalize(const State& state) const {
  State result;
  for (int d = 0; d < state_size; ++d) result[d] = mean[d] + sigma[d] * state[d];
  return result;
}

}  // namespace touchtrace
