#include "engine/train/update_plan.h"

#include <algorithm>

#include "engine/cl/watch.h"
#include "engine/train/noise_batch.h"

namespace touchtrace {

std::vector<PlannedLaunch> launches_of_update(Runtime& runtime, const ModelSpec& spec,
                                              int sequences, int steps, const LiveTaxels& live,
                                              const Tuning& tuning) {
  RandomStream random(1, "plan of an update");
  const int frames = std::max(spec.window_frames, spec.segment_frames) + steps;
  auto stream = noise_stream(spec, frames, random);
  for (std::size_t i = 0; i < stream.size() && !live.empty(); ++i)
    stream[i] *= live[i % live.size()];
  Trainer trainer(runtime, spec, {}, sequences, steps, stream, tuning);
  if (spec.object == ObjectEncoder::frozen) trainer.freeze_objects(noise_objects(spec, random));
  const auto batch = noise_batch(spec, sequences, steps, frames, random);
  std::vector<PlannedLaunch> launches;
  visit_launches(
      runtime, [&] { trainer.update(batch); },
      [&](const Launch& launch) {
        launches.push_back({launch.name(), launch.cost(), launch.is_tuned()});
      });
  return launches;
}

}  // namespace touchtrace
