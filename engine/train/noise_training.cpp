#include "engine/train/noise_training.h"

#include <algorithm>

#include "engine/train/noise_batch.h"

namespace touchtrace {
namespace {

int frames_of(const ModelSpec& spec, int steps) {
  return 2 * std::max(spec.window_frames, spec.segment_frames) + steps;
}

std::vector<float> live_noise(const ModelSpec& spec, int frames, const LiveTaxels& live,
                              RandomStream& random) {
  auto stream = noise_stream(spec, frames, random);
  for (std::size_t i = 0; i < stream.size() && !live.empty(); ++i)
    stream[i] *= live[i % live.size()];
  return stream;
}

}  // namespace

NoiseTraining::NoiseTraining(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                             const LiveTaxels& live, const TrainOptions& options)
    : random_(1, "training on noise"),
      trainer_(runtime, spec, options, sequences, steps,
               live_noise(spec, frames_of(spec, steps), live, random_)),
      batch_(noise_batch(spec, sequences, steps, frames_of(spec, steps), random_)) {
  if (spec.object == ObjectEncoder::frozen) trainer_.freeze_objects(noise_objects(spec, random_));
}

}  // namespace touchtrace
