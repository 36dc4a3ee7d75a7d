#pragma once

#include "engine/train/safetensors.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Segments of touch with the object in hand.
struct SegmentBatch {
  std::vector<std::int32_t> first_frame;  ///< [N], of segment_frames frames each
  std::vector<std::int32_t> object;       ///< [N], a number for each object
};

/// Contrastive training of the object encoder alone, before its embeddings are frozen (section
/// IV-B): segments of the same object are drawn together, those of different ones apart.
class ObjectTrainer {
 public:
  /// `segments`: N of every batch. `tactile`: [frames, rows, cols]. `tuning`: as in trainer.h.
  ObjectTrainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options, int segments,
                std::span<const float> tactile, const Tuning& tuning = {});
  ~ObjectTrainer();

  /// One update of the contrastive loss (equation 5): all segments of a batch with a segment's
  /// object are its positives, those of other objects its negatives. Returns the loss before the
  /// update. Throws Error(failed) if loss or gradient is not finite.
  double update(const SegmentBatch& batch);
  int updates() const;

  /// "object.conv1.weight" and so on, for ObjectEmbedder and Trainer::freeze_objects.
  std::vector<Tensor> weights() const;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace touchtrace
