#pragma once

#include <string>
#include <vector>

#include "engine/base/random.h"
#include "engine/train/object_trainer.h"
#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// The objects of the training clips, in the order of their names.
std::vector<std::string> training_objects(const Dataset& data);

/// How the object encoder is trained before its embeddings are frozen.
struct ObjectTraining {
  int updates = 600;
  int segments = 32;  ///< of a batch
};

/// Random segments of touch of the training clips, as many of each object. A batch depends on the
/// seed and its number alone.
class SegmentSampler {
 public:
  /// Throws data_error if an object has no training clip of `frames` frames.
  SegmentSampler(const Dataset& data, int frames, int segments, std::uint64_t seed);

  SegmentBatch batch(int index) const;
  /// Every `stride`-th segment of all training clips, object by object.
  SegmentBatch all(int stride) const;

 private:
  std::vector<std::vector<std::int32_t>> first_frames_;  ///< of all segments, object by object
  int segments_;
  RandomStream random_;
};

/// Contrastive training of an object encoder on the training clips (section IV-B): "object.*".
/// `tuning`: as in trainer.h.
std::vector<Tensor> train_object_encoder(Runtime& runtime, const Dataset& data,
                                         const ModelSpec& spec, const TrainOptions& options,
                                         const ObjectTraining& how, const Tuning& tuning);

/// The encoder with the embedding of each training object, the mean over the segments of its
/// training clips.
FrozenObjects freeze_objects(Runtime& runtime, const Dataset& data, const ModelSpec& spec,
                             std::vector<Tensor> encoder);

}  // namespace touchtrace::study
