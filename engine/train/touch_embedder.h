#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/model/touch_encoder.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Embeddings of some windows: window i has row row[i] of `values` [rows, embedding].
struct TouchEmbeddings {
  std::vector<std::int32_t> row;
  std::vector<float> values;
};

/// A trained encoder of touch: from windows of a stream to the embeddings g_t, or from segments to
/// e_i. An embedding does not depend on what is asked for along with it.
class TouchEmbedder {
 public:
  /// `name` "tactile" takes the model's windows, "object" its segments. Throws data_error if a
  /// weight "NAME.*" is missing or has another size.
  TouchEmbedder(Runtime& runtime, const std::string& name, const ModelSpec& spec,
                const TensorFile& weights);

  /// [N, embedding], of the windows of `stream` [frames, rows, cols] that end with `last_frame`
  /// [N]. Throws data_error if one does not lie in the stream.
  std::vector<float> embed(const Buffer<float>& stream, std::span<const std::int32_t> last_frame);

  /// The same, of windows of `tactile`, which `stream` holds too: equal ones are encoded once.
  TouchEmbeddings embed_distinct(std::span<const float> tactile, const Buffer<float>& stream,
                                 std::span<const std::int32_t> last_frame);

 private:
  void fit(int windows);
  void check(const Buffer<float>& stream, std::span<const std::int32_t> last_frame) const;

  Runtime& runtime_;
  std::string name_;
  TactileEncoderShape shape_;
  ParameterTable table_;
  Weights weights_;
  int embedding_, windows_ = 0;
  std::unique_ptr<TouchEncoder> encoder_;  ///< for windows_ windows at a time
};

}  // namespace touchtrace
