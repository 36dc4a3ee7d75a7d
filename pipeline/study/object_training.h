#pragma once

#include <string>
#include <vector>

#include "engine/base/random.h"
#include "engine/train/object_trainer.h"
#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Names of the training clips' objects, sorted.
std::vector<std::string> training_objects(const Dataset& data);

/// Training of the object encoder before its embeddings are frozen.
struct ObjectTraining {
  int updates = 600;
  int segments = 32;  ///< per batch
};

/// Samples tactile segments of the training clips, equally many per object. A batch depends only on
/// the seed and its index.
class SegmentSampler {
 public:
  /// Throws data_error if an object has no training clip of `frames` frames.
  SegmentSampler(const Dataset& data, int frames, int segments, std::uint64_t seed);

  SegmentBatch batch(int index) const;
  /// Every `stride`-th segment of all training clips, ordered by object.
  SegmentBatch all(int stride) const;

 private:
  std::vector<std::vector<std::int32_t>> first_frames_;  ///< [objects, segments]
  int segments_;
  RandomStream random_;
};

/// Trains an object encoder on the training clips by the contrastive loss (section IV-B). Returns
/// the tensors "object.*".
std::vector<Tensor> train_object_encoder(Runtime& runtime, const Dataset& data,
                                         const ModelSpec& spec, const TrainOptions& options,
                                         const ObjectTraining& how);

/// Computes the embedding of each training object, the mean over all segments of its training
/// clips.
FrozenObjects freeze_objects(Runtime& runtime, const Dataset& data, const ModelSpec& spec,
                             std::vector<Tensor> encoder);

/// Mean over the training objects of each one's mean embedding: [embedding]. Throws data_error as
/// SegmentSampler does.
std::vector<float> mean_training_embedding(Runtime& runtime, const Dataset& data,
                                           const ModelSpec& spec, std::vector<Tensor> encoder);

}  // namespace touchtrace::study
