#include "engine/model/tactile_encoder.h"

namespace touchtrace {

namespace {

ConvStackShape encoder_of(const ModelSpec& spec, int windows, int frames, const LiveTaxels& live) {
  return {{windows, frames, spec.rows, spec.cols}, spec.tactile_kernel, spec.tactile_strides, live};
}

}  // namespace

ConvStackShape window_encoder(const ModelSpec& spec, int windows, const LiveTaxels& live) {
  return encoder_of(spec, windows, spec.window_frames, live);
}

ConvStackShape segment_encoder(const ModelSpec& spec, int segments, const LiveTaxels& live) {
  return encoder_of(spec, segments, spec.segment_frames, live);
}

void TactileEncoder::declare(const std::string& name, const ConvStackShape& shape, int embedding,
                             ParameterTable& table) {
  ConvStack::declare(name, shape, table);
  EmbeddingHead::declare(name, embedding, shape.features(), table);
}

TactileEncoder::TactileEncoder(Runtime& runtime, const std::string& name,
                               const ConvStackShape& shape, const Weights& weights)
    : runtime_(runtime),
      convolutions_(runtime, name, shape, weights),
      window_end_(runtime.allocate<int>(std::size_t(shape.windows.windows))),
      head_(runtime, name, weights, shape.features(), convolutions_.features(),
            convolutions_.grad_features()) {}

void TactileEncoder::prepare() {
  convolutions_.prepare();
  enqueue(runtime_, head_.prepare());
}

void TactileEncoder::forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
  convolutions_.forward(stream, window_end_, dropout);
  enqueue(runtime_, head_.forward());
}

void TactileEncoder::backward() {
  enqueue(runtime_, head_.backward());
  convolutions_.backward();
}

}  // namespace touchtrace
