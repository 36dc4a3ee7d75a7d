#include "engine/model/touch_encoder.h"

namespace touchtrace {

TouchEncoder::TouchEncoder(Runtime& runtime, const std::string& name,
                           const TactileWindowShape& windows, int embedding, bool training,
                           ParameterTable& table)
    : runtime_(runtime),
      name_(name),
      convolutions_(runtime, name, windows, training, table),
      last_frame_(runtime.allocate<int>(std::size_t(windows.windows))) {
  TouchEmbedding::declare(name, embedding, convolutions_.feature_size(), table);
}

void TouchEncoder::plan(const Weights& weights) {
  values_ = weights.values, gradient_ = weights.gradient;
  embedding_ = std::make_unique<TouchEmbedding>(runtime_, name_, weights, convolutions_.features(),
                                                convolutions_.windows());
}

void TouchEncoder::forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
  convolutions_.forward(stream, last_frame_, values_, dropout);
  enqueue(runtime_, embedding_->forward());
}

void TouchEncoder::backward() {
  enqueue(runtime_, embedding_->backward());
  convolutions_.backward(embedding_->grad_features(), gradient_);
}

}  // namespace touchtrace
