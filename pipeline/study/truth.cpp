#include "pipeline/study/truth.h"

namespace touchtrace::study {
namespace {

constexpr int object_at = 0, hand_at = 6;

/// Mean of label - truth over trusted training frames, dimensions `first` .. `first` + 2.
std::array<double, 3> mean_difference(const Dataset& data, int first) {
  std::array<double, 3> sum{};
  int frames = 0;
  for (const auto& sequence : data.sequences) {
    if (sequence.split != Split::train) continue;
    for (int f = sequence.first_frame; f < sequence.first_frame + sequence.frames; ++f) {
      if (!data.trusted[f]) continue;
      ++frames;
      for (int d = 0; d < 3; ++d)
        sum[d] += static_cast<double>(data.label[f][first + d]) - data.truth[f][first + d];
    }
  }
  for (double& value : sum) value = frames > 0 ? value / frames : 0.0;
  return sum;
}

}  // namespace

TruthOffset estimate_offset(const Dataset& data) {
  return {mean_difference(data, object_at), mean_difference(data, hand_at)};
}

void shift_truth(Dataset& data, const TruthOffset& offset) {
  for (State& state : data.truth)
    for (int d = 0; d < 3; ++d) {
      state[object_at + d] += static_cast<float>(offset.object_m[d]);
      state[hand_at + d] += static_cast<float>(offset.hand_m[d]);
    }
}

}  // namespace touchtrace::study
