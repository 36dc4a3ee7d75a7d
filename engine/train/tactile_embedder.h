#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/model/tactile_encoder.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Embeddings of windows, equal windows stored once: window i has row row[i] of `values`.
struct DistinctEmbeddings {
  std::vector<std::int32_t> row;  ///< [windows]
  std::vector<float> values;      ///< [rows, embedding]
};

/// A trained tactile encoder: computes g_t from windows or e_i from segments of a stream. An
/// embedding depends on no other window of the call, not even in the last bit.
class TactileEmbedder {
 public:
  /// `name`: "tactile" for windows, "object" for segments. Throws data_error if a weight "NAME.*"
  /// is missing or has another size.
  TactileEmbedder(Runtime& runtime, const std::string& name, const ModelSpec& spec,
                  const TensorFile& weights);

  /// [N, embedding] of the windows of `stream` [frames, rows, cols] whose last frames are
  /// `window_end` [N]. Throws data_error if a window is outside the stream.
  std::vector<float> embed(const Buffer<float>& stream, std::span<const std::int32_t> window_end);

  /// The same, encoding equal windows once. `tactile`: host copy of `stream`.
  DistinctEmbeddings embed_distinct(std::span<const float> tactile, const Buffer<float>& stream,
                                    std::span<const std::int32_t> window_end);

 private:
  /// Makes the encoder take `windows` windows at a time.
  void resize(int windows);
  void check(const Buffer<float>& stream, std::span<const std::int32_t> window_end) const;

  Runtime& runtime_;
  std::string name_;
  ConvStackShape shape_;
  ParameterTable table_;
  Weights weights_;
  int embedding_, windows_ = 0;
  std::unique_ptr<TactileEncoder> encoder_;  ///< for windows_ windows
};

}  // namespace touchtrace
