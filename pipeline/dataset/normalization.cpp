#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace {
namespace {

using Sums = std::array<double, state_size>;

/// Adds term(d, value) of every trusted label of a split, or of all clips, to sums[d]; returns the
/// number of labels.
template <class Term>
std::size_t sum_over(const Dataset& dataset, std::optional<Split> split, Sums& sums, Term term) {
  std::size_t count = 0;
  for (const auto& sequence : dataset.sequences) {
    if (split && sequence.split != *split) continue;
    for (int frame = sequence.first_frame; frame < sequence.first_frame + sequence.frames;
         ++frame) {
      if (!dataset.trusted[frame]) continue;
      ++count;
      for (int d = 0; d < state_size; ++d) sums[d] += term(d, dataset.label[frame][d]);
    }
  }
  return count;
}

/// nullopt without labels.
std::optional<Normalization> fit(const Dataset& dataset, std::optional<Split> split) {
  Sums mean{}, square{};
  const auto count = sum_over(dataset, split, mean, [](int, double value) { return value; });
  if (count == 0) return std::nullopt;
  for (double& value : mean) value /= static_cast<double>(count);
  sum_over(dataset, split, square,
           [&](int d, double value) { return (value - mean[d]) * (value - mean[d]); });
  Normalization result;
  for (int d = 0; d < state_size; ++d) {
    result.mean[d] = static_cast<float>(mean[d]);
    result.sigma[d] =
        std::max(min_sigma, static_cast<float>(std::sqrt(square[d] / static_cast<double>(count))));
  }
  return result;
}

}  // namespace

Normalization fit_normalization(const Dataset& dataset) {
  if (const auto result = fit(dataset, Split::train)) return *result;
  throw data_error(
      "no training clip has a label of good quality",
      "`touchtrace check` lists the flags of labels; label again with better boxes, record "
      "more clips, or check that the times of your own labels are the recording's");
}

std::optional<Normalization> fit_normalization_of_all_clips(const Dataset& dataset) {
  return fit(dataset, std::nullopt);
}

double Normalization::position_spread_m() const {
  double variance = 0.0;
  for (const int d : {0, 1, 2, 6, 7, 8}) variance += sigma[d] * sigma[d];
  return std::sqrt(variance);
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
