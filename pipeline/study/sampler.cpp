#include "pipeline/study/sampler.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/study/object_training.h"

namespace touchtrace::study {

Sampler::Sampler(const Dataset& data, const Normalization& scaling, const ModelSpec& spec,
                 int sequences, int steps, std::uint64_t seed)
    : data_(data),
      scaling_(scaling),
      spec_(spec),
      sequences_(sequences),
      steps_(steps),
      random_(seed, "batches"),
      segments_(seed, "segments of batches") {
  const RolloutGrid every_start{Split::train, steps, 1, required_history(spec)};
  starts_ = find_starts(data, every_start);
  std::erase_if(starts_, [&](const Start& start) {  // nothing to learn from
    const auto first = data.trusted.begin() + start.frame + 1;
    return std::find(first, first + steps, 1) == first + steps;
  });
  if (starts_.empty())
    throw data_error(fmt::format("no training clip has {} frames of touch followed by {} steps",
                                 required_history(spec), steps),
                     "record longer clips, or lower --window or --steps");
  const auto names = training_objects(data);
  for (const auto& sequence : data.sequences)
    object_.push_back(static_cast<int>(std::ranges::find(names, sequence.object) - names.begin()));
}

RolloutBatch Sampler::batch(int index) const {
  RolloutBatch batch;
  batch.steps = steps_;
  for (int s = 0; s < sequences_; ++s) {
    const std::uint64_t draw = static_cast<std::uint64_t>(index) * sequences_ + s;
    const double place = random_.uniform_at(draw);
    const auto& start =
        starts_[static_cast<std::size_t>(place * static_cast<double>(starts_.size()))];
    append_rollout(batch, data_, scaling_, Reference::labels, start.frame);
    if (spec_.object != ObjectEncoder::none) append_object(batch, start.sequence, draw);
  }
  return batch;
}

void Sampler::append_object(RolloutBatch& batch, int sequence, std::uint64_t draw) const {
  const auto& clip = data_.sequences[sequence];
  const int segments = clip.frames - spec_.segment_frames + 1;
  batch.object.push_back(object_[sequence]);
  batch.segment_frame.push_back(clip.first_frame +
                                static_cast<int>(segments_.uniform_at(draw) * segments));
}

}  // namespace touchtrace::study
