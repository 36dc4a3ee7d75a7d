#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"
#include "engine/train/safetensors.h"
#include "engine/train/train_options.h"

namespace touchtrace {

/// Segments of tactile frames, each with its object.
struct SegmentBatch {
  std::vector<std::int32_t> first_frame;  ///< [N], of segment_frames frames each
  std::vector<std::int32_t> object;       ///< [N] object index
};

/// Contrastive training of the object encoder alone, before its embeddings are frozen (section
/// IV-B).
class ObjectTrainer {
 public:
  /// `segments`: N of every batch. `tactile`: [frames, rows, cols].
  /// `options.max_consecutive_skips` is ignored: no update is skipped.
  ObjectTrainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options, int segments,
                std::span<const float> tactile);
  ~ObjectTrainer();

  /// One update of the contrastive loss (equation 5): segments of the same object are positives,
  /// others negatives. Returns the loss before the update. Throws Error(failed) if loss or gradient
  /// is not finite.
  double update(const SegmentBatch& batch);
  int updates() const;

  /// "object.conv1.weight" and so on, for ObjectEmbedder and Trainer::freeze_objects.
  std::vector<Tensor> weights() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchtrace
