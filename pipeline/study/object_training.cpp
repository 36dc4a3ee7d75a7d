#include "pipeline/study/object_training.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/train/object_embedder.h"

namespace touchtrace::study {

std::vector<std::string> training_objects(const Dataset& data) {
  std::set<std::string> objects;
  for (const auto& sequence : data.sequences)
    if (sequence.split == Split::train) objects.insert(sequence.object);
  return {objects.begin(), objects.end()};
}

SegmentSampler::SegmentSampler(const Dataset& data, int frames, int segments, std::uint64_t seed)
    : segments_(segments), random_(seed, "segments") {
  for (const auto& object : training_objects(data)) {
    auto& starts = first_frames_.emplace_back();
    for (const auto& sequence : data.sequences) {
      if (sequence.split != Split::train || sequence.object != object) continue;
      const int last = sequence.first_frame + sequence.frames - frames;
      for (int first = sequence.first_frame; first <= last; ++first) starts.push_back(first);
    }
    if (starts.empty())
      throw data_error(fmt::format("no training clip of '{}' has {} frames", object, frames),
                       "record longer clips, or use --object-encoder none");
  }
}

SegmentBatch SegmentSampler::batch(int index) const {
  SegmentBatch batch;
  for (int i = 0; i < segments_; ++i) {
    const auto object = static_cast<std::size_t>(i) % first_frames_.size();
    const auto& starts = first_frames_[object];
    const double place = random_.uniform_at(static_cast<std::uint64_t>(index) * segments_ + i);
    batch.first_frame.push_back(
        starts[static_cast<std::size_t>(place * static_cast<double>(starts.size()))]);
    batch.object.push_back(static_cast<std::int32_t>(object));
  }
  return batch;
}

SegmentBatch SegmentSampler::all(int stride) const {
  SegmentBatch batch;
  for (std::size_t object = 0; object < first_frames_.size(); ++object)
    for (std::size_t i = 0; i < first_frames_[object].size(); i += stride) {
      batch.first_frame.push_back(first_frames_[object][i]);
      batch.object.push_back(static_cast<std::int32_t>(object));
    }
  return batch;
}

std::vector<Tensor> train_object_encoder(Runtime& runtime, const Dataset& data,
                                         const ModelSpec& spec, const TrainOptions& options,
                                         const ObjectTraining& how) {
  const SegmentSampler sampler(data, spec.segment_frames, how.segments, options.seed);
  TrainOptions object_options = options;
  object_options.updates = how.updates;
  ObjectTrainer trainer(runtime, spec, object_options, how.segments, data.tactile);
  Progress progress("training the object encoder", static_cast<std::uint64_t>(how.updates));
  while (trainer.updates() < how.updates) {
    const double loss = trainer.update(sampler.batch(trainer.updates()));
    progress.advance(1, fmt::format("contrastive loss {:.3f}", loss));
  }
  return trainer.weights();
}

FrozenObjects freeze_objects(Runtime& runtime, const Dataset& data, const ModelSpec& spec,
                             std::vector<Tensor> encoder) {
  const auto segments =
      SegmentSampler(data, spec.segment_frames, 1, 0).all(spec.segment_frames / 2);
  const int objects = segments.object.back() + 1;
  ObjectEmbedder embedder(runtime, spec, {{}, encoder});
  const auto stream = runtime.upload<float>(data.tactile);
  const auto embeddings = embedder.embed(stream, segments.first_frame);
  return {std::move(encoder), mean_embeddings(embeddings, segments.object, objects)};
}

std::vector<float> mean_training_embedding(Runtime& runtime, const Dataset& data,
                                           const ModelSpec& spec, std::vector<Tensor> encoder) {
  const auto of_objects = freeze_objects(runtime, data, spec, std::move(encoder)).embedding;
  const std::vector<std::int32_t> same(of_objects.size() / static_cast<std::size_t>(spec.embedding),
                                       0);
  return mean_embeddings(of_objects, same, 1);
}

}  // namespace touchtrace::study
