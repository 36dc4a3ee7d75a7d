#include "engine/model/touch_encoder.h"

namespace touchtrace {

namespace {

TactileEncoderShape encoder_of(const ModelSpec& spec, int windows, int frames,
                               const LiveTaxels& live) {
  return {{windows, frames, spec.rows, spec.cols}, spec.tactile_kernel, spec.tactile_strides, live};
}

}  // namespace

TactileEncoderShape window_encoder(const ModelSpec& spec, int windows, const LiveTaxels& live) {
  return encoder_of(spec, windows, spec.window_frames, live);
}

TactileEncoderShape segment_encoder(const ModelSpec& spec, int segments, const LiveTaxels& live) {
  return encoder_of(spec, segments, spec.segment_frames, live);
}

void TouchEncoder::declare(const std::string& name, const TactileEncoderShape& shape, int embedding,
                           ParameterTable& table) {
  TactileEncoder::declare(name, shape, table);
  TouchEmbedding::declare(name, embedding, shape.features(), table);
}

TouchEncoder::TouchEncoder(Runtime& runtime, const std::string& name,
                           const TactileEncoderShape& shape, const Weights& weights,
                           const Tuning& tuning)
    : runtime_(runtime),
      convolutions_(runtime, name, shape, weights, tuning),
      last_frame_(runtime.allocate<int>(std::size_t(shape.windows.windows))),
      embedding_(runtime, name, weights, shape.features(), convolutions_.features(),
                 convolutions_.grad_features()) {}

void TouchEncoder::prepare() {
  convolutions_.prepare();
  enqueue(runtime_, embedding_.prepare());
}

void TouchEncoder::forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
  convolutions_.forward(stream, last_frame_, dropout);
  enqueue(runtime_, embedding_.forward());
}

void TouchEncoder::forward_early(const Buffer<float>& stream) {
  convolutions_.forward_early(stream, last_frame_);
}

void TouchEncoder::forward_late(const Buffer<float>& stream) {
  convolutions_.forward_late(stream, last_frame_);
  enqueue(runtime_, embedding_.forward());
}

void TouchEncoder::backward() {
  enqueue(runtime_, embedding_.backward());
  convolutions_.backward();
}

}  // namespace touchtrace
