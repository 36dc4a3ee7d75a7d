#include "pipeline/study/sampler.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace::study {

Sampler::Sampler(const Dataset& data, const Normalization& scaling, int sequences, int steps,
                 int history, std::uint64_t seed)
    : data_(data),
      scaling_(scaling),
      sequences_(sequences),
      steps_(steps),
      random_(seed, "batches") {
  const RolloutGrid every_start{Split::train, steps, 1, history};
  for (const auto& [sequence, start] : starts_of(data, every_start)) starts_.push_back(start);
  if (starts_.empty())
    throw data_error(
        fmt::format("no training clip holds a window of {} frames and {} steps after it", history,
                    steps),
        "record longer clips, or lower --window or --steps");
}

RolloutBatch Sampler::batch(int index) const {
  RolloutBatch batch;
  batch.steps = steps_;
  for (int s = 0; s < sequences_; ++s) {
    const double place = random_.uniform_at(static_cast<std::uint64_t>(index) * sequences_ + s);
    append_rollout(batch, data_, scaling_, Reference::labels,
                   starts_[static_cast<std::size_t>(place * static_cast<double>(starts_.size()))]);
  }
  return batch;
}

}  // namespace touchtrace::study
