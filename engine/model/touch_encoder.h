#pragma once

#include <string>

#include "engine/model/model_spec.h"
#include "engine/model/tactile_encoder.h"
#include "engine/model/touch_embedding.h"

namespace touchtrace {

/// Of the encoder that makes g_t from windows of touch, and of that which makes e_i from segments.
TactileEncoderShape window_encoder(const ModelSpec& spec, int windows, const LiveTaxels& live = {});
TactileEncoderShape segment_encoder(const ModelSpec& spec, int segments,
                                    const LiveTaxels& live = {});

/// From windows of touch to embeddings: three convolutions, a dense layer, LayerNorm. "tactile"
/// makes g_t from the M frames before a step, "object" makes e_i from a segment of some twenty
/// frames with object i in hand (section III-C).
class TouchEncoder {
 public:
  /// Adds the parameters "NAME.conv1.weight" ... "NAME.norm.bias" to `table`.
  static void declare(const std::string& name, const TactileEncoderShape& shape, int embedding,
                      ParameterTable& table);
  /// There is a backward pass if `weights` has a gradient; only then `tuning` counts.
  TouchEncoder(Runtime& runtime, const std::string& name, const TactileEncoderShape& shape,
               const Weights& weights, const Tuning& tuning = {});

  /// To be called whenever the weights changed.
  void prepare();
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout);
  /// As in tactile_encoder.h.
  void forward_early(const Buffer<float>& stream);
  void forward_late(const Buffer<float>& stream);
  /// From grad_embedding(): adds to the weights' gradient of the convolutions, writes the others.
  void backward();

  /// [windows], the last frame of each in the stream; for the caller to write.
  const Buffer<int>& last_frame() const { return last_frame_; }
  const Buffer<float>& embedding() const { return embedding_.embedding(); }  ///< [windows, size]
  const Buffer<float>& grad_embedding() const { return embedding_.grad_embedding(); }

 private:
  Runtime& runtime_;
  TactileEncoder convolutions_;
  Buffer<int> last_frame_;
  TouchEmbedding embedding_;
};

}  // namespace touchtrace
