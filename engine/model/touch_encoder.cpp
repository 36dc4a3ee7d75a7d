#include "engine/model/touch_encoder.h"

namespace touchtrace {

void TouchEncoder::declare(const std::string& name, const TactileWindowShape& windows,
                           int embedding, ParameterTable& table) {
  TactileEncoder::declare(name, windows, table);
  TouchEmbedding::declare(name, embedding, TactileEncoder::features_shape(windows), table);
}

TouchEncoder::TouchEncoder(Runtime& runtime, const std::string& name,
                           const TactileWindowShape& windows, const Weights& weights)
    : runtime_(runtime),
      convolutions_(runtime, name, windows, weights),
      last_frame_(runtime.allocate<int>(std::size_t(windows.windows))),
      embedding_(runtime, name, weights, TactileEncoder::features_shape(windows),
                 convolutions_.features(), convolutions_.grad_features()) {}

void TouchEncoder::prepare() {
  convolutions_.prepare();
  enqueue(runtime_, embedding_.prepare());
}

void TouchEncoder::forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
  convolutions_.forward(stream, last_frame_, dropout);
  enqueue(runtime_, embedding_.forward());
}

void TouchEncoder::backward() {
  enqueue(runtime_, embedding_.backward());
  convolutions_.backward();
}

}  // namespace touchtrace
