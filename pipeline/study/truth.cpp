#include "pipeline/study/truth.h"

#include <array>

#include "pipeline/study/metrics.h"

namespace touchtrace::study {

State estimate_truth_offset(const Dataset& data) {
  std::array<double, state_size> sum{};
  int frames = 0;
  for (const auto& sequence : data.sequences) {
    if (sequence.split != Split::train) continue;
    for (int f = sequence.first_frame; f < sequence.first_frame + sequence.frames; ++f) {
      if (!data.trusted[f]) continue;
      ++frames;
      for (int d = 0; d < state_size; ++d)
        sum[d] += static_cast<double>(data.label[f][d]) - data.truth[f][d];
    }
  }
  State offset{};
  for (const auto [first, count] : {object_position, hand_position})
    for (int d = first; frames > 0 && d < first + count; ++d)
      offset[d] = static_cast<float>(sum[d] / frames);
  return offset;
}

void shift_truth(Dataset& data, const State& offset) {
  for (int d = 0; d < state_size; ++d) {
    data.truth_offset[d] += offset[d];
    for (State& state : data.truth) state[d] += offset[d];
  }
}

}  // namespace touchtrace::study
