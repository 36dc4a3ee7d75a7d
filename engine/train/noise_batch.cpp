#include "engine/train/noise_batch.h"

namespace touchtrace {

std::vector<float> noise_stream(const ModelSpec& spec, int frames, RandomStream& random) {
  return normal_floats(std::size_t(frames) * spec.rows * spec.cols, random);
}

constexpr int noise_object_count = 3;

FrozenObjects noise_objects(const ModelSpec& spec, RandomStream& random) {
  return {{}, normal_floats(std::size_t(noise_object_count) * spec.embedding, random)};
}

RolloutBatch noise_batch(const ModelSpec& spec, int sequences, int steps, int frames,
                         RandomStream& random) {
  RolloutBatch batch;
  batch.sequences = sequences, batch.steps = steps;
  const int first = spec.window_frames - 1;
  for (int s = 0; s < sequences; ++s)
    batch.first_frame.push_back(first + int(random.below(frames - first - steps + 1)));
  const auto rows = std::size_t(sequences) * steps;
  batch.initial_state = normal_floats(std::size_t(sequences) * spec.state, random);
  batch.target = normal_floats(rows * spec.state, random);
  for (std::size_t i = 0; i < rows; ++i) batch.weight.push_back(float(random.uniform(0.0, 2.0)));
  if (spec.object == ObjectEncoder::none) return batch;
  for (int s = 0; s < sequences; ++s) {
    batch.object.push_back(s % noise_object_count);
    batch.segment_frame.push_back(int(random.below(frames - spec.segment_frames + 1)));
  }
  return batch;
}

}  // namespace touchtrace
