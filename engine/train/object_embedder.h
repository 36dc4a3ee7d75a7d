#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/train/tactile_embedder.h"

namespace touchtrace {

/// A trained object encoder: computes embeddings e_i from segments of tactile frames.
class ObjectEmbedder {
 public:
  /// Throws data_error if a weight "object.*" is missing or has another size.
  ObjectEmbedder(Runtime& runtime, const ModelSpec& spec, const TensorFile& weights);

  /// [N, embedding] of the segments of `stream` [frames, rows, cols] that start at `first_frame`
  /// [N]. Throws data_error if a segment is outside the stream.
  std::vector<float> embed(const Buffer<float>& stream, std::span<const std::int32_t> first_frame);

 private:
  ModelSpec spec_;
  TactileEmbedder embedder_;
};

/// Returns the tensors "object.*" of a model or a checkpoint.
std::vector<Tensor> object_encoder_of(TensorFile file);

/// Mean of the rows of `embeddings` [N, size] of each object 0 .. objects - 1: [objects, size].
/// Each object must have a row.
std::vector<float> mean_embeddings(std::span<const float> embeddings,
                                   std::span<const std::int32_t> object, int objects);

}  // namespace touchtrace
