#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/train/touch_embedder.h"

namespace touchtrace {

/// A trained object encoder: from segments of touch to embeddings e_i.
class ObjectEmbedder {
 public:
  /// Throws data_error if a weight "object.*" is missing or has another size.
  ObjectEmbedder(Runtime& runtime, const ModelSpec& spec, const TensorFile& weights);

  /// [N, embedding], of the segments of `stream` [frames, rows, cols] that begin at `first_frame`
  /// [N]. Throws data_error if one does not lie in the stream.
  std::vector<float> embed(const Buffer<float>& stream, std::span<const std::int32_t> first_frame);

 private:
  ModelSpec spec_;
  TouchEmbedder embedder_;
};

/// The tensors "object.*" of a model or a checkpoint.
std::vector<Tensor> object_encoder_of(TensorFile file);

/// The mean of the rows of [N, size] that belong to each object 0 .. objects - 1: [objects, size].
/// Every object has a row.
std::vector<float> mean_embeddings(std::span<const float> embeddings,
                                   std::span<const std::int32_t> object, int objects);

}  // namespace touchtrace
