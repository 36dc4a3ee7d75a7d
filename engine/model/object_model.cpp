#include "engine/model/object_model.h"

#include "engine/ops/info_nce.h"
#include "engine/ops/sum.h"

namespace touchtrace {

namespace {

ParameterTable object_parameters(const ModelSpec& spec) {
  validate(spec);
  ParameterTable table;
  TactileEncoder::declare("object", segment_encoder(spec, 1), spec.embedding, table);
  return table;
}

}  // namespace

ObjectModel::ObjectModel(Runtime& runtime, const ModelSpec& spec, int segments)
    : runtime_(runtime),
      segments_(segments),
      table_(object_parameters(spec)),
      weights_(allocate_weights(runtime, table_, true)),
      encoder_(runtime, "object", segment_encoder(spec, segments), weights_) {
  plan_loss(spec);
}

void ObjectModel::plan_loss(const ModelSpec& spec) {
  const auto count = static_cast<std::size_t>(segments_);
  object_ = runtime_.allocate<int>(count);
  weight_ = runtime_.allocate<float>(count);
  loss_ = runtime_.allocate<float>(1);
  const auto row_loss = runtime_.allocate<float>(count);
  loss_launches_ = info_nce(runtime_, {.count = segments_,
                                       .columns = spec.embedding,
                                       .temperature = spec.contrast_temperature,
                                       .embedding = encoder_.embedding(),
                                       .object = object_,
                                       .weight = weight_,
                                       .row_loss = row_loss,
                                       .row_loss_at = 0,
                                       .grad_embedding = encoder_.grad_embedding()});
  loss_launches_.push_back(sum(runtime_, row_loss, loss_));
}

void ObjectModel::backward() {
  runtime_.fill(weights_.gradient, 0.0f);
  runtime_.fill(encoder_.grad_embedding(), 0.0f);
  enqueue(runtime_, loss_launches_);
  encoder_.backward();
}

}  // namespace touchtrace
