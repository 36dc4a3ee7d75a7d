#include "engine/model/model.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/ops/info_nce.h"
#include "engine/ops/state_loss.h"
#include "engine/ops/sum.h"

namespace touchtrace {
namespace {

/// Adds the size of the model to an error.
Error with_model_size(const ModelSpec& spec, int sequences, int steps, const Error& error) {
  const auto windows = spec.touch ? fmt::format(" with windows of {} x {} x {}", spec.window_frames,
                                                spec.rows, spec.cols)
                                  : "";
  return Error(error.code(),
               fmt::format("model for {} sequences of {} steps{}: {}", sequences, steps, windows,
                           error.what()),
               error.hint());
}

}  // namespace

Model::Model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps, Use use,
             const LiveTaxels& live) try
    : runtime_(runtime), spec_(spec), sequences_(sequences), steps_(steps) {
  validate(spec);
  const bool has_object_encoder = spec.object == ObjectEncoder::joint && use == Use::training;
  if (spec.touch && use != Use::rollout)
    TactileEncoder::declare("tactile", window_encoder(spec, 1), spec.embedding, table_);
  if (has_object_encoder)
    TactileEncoder::declare("object", segment_encoder(spec, 1), spec.embedding, table_);
  declare_dynamics(spec, table_);
  weights_ = std::make_unique<Weights>(allocate_weights(runtime, table_, use == Use::training));
  if (spec.touch && use == Use::rollout)
    input_.tactile_embedding =
        runtime.allocate<float>(std::size_t(sequences) * steps * spec.embedding);
  else if (spec.touch)
    plan_tactile_encoder(live);
  if (has_object_encoder)
    plan_object_encoder(live);
  else if (spec.object != ObjectEncoder::none)
    input_.object_embedding = runtime.allocate<float>(std::size_t(sequences) * spec.embedding);
  dynamics_ = make_dynamics(runtime, spec, *weights_, embeddings(), sequences, steps);
  if (use == Use::training) plan_loss();
} catch (const Error& error) {
  if (error.code() != ExitCode::no_device) throw;
  throw with_model_size(spec, sequences, steps, error);
}

void Model::plan_tactile_encoder(const LiveTaxels& live) {
  tactile_ = std::make_unique<TactileEncoder>(
      runtime_, "tactile", window_encoder(spec_, sequences_ * steps_, live), *weights_);
  input_.window_end = tactile_->window_end();
}

void Model::plan_object_encoder(const LiveTaxels& live) {
  object_ = std::make_unique<TactileEncoder>(runtime_, "object",
                                             segment_encoder(spec_, sequences_, live), *weights_);
  input_.segment_end = object_->window_end();
  input_.object = runtime_.allocate<std::int32_t>(std::size_t(sequences_));
  input_.contrast_weight = runtime_.allocate<float>(std::size_t(sequences_));
}

Embeddings Model::embeddings() const {
  return {tactile_ ? tactile_->embedding() : input_.tactile_embedding,
          object_ ? object_->embedding() : input_.object_embedding};
}

void Model::plan_loss() {
  const auto rows = static_cast<std::size_t>(sequences_) * steps_;
  dynamics_->plan_backward(runtime_, {tactile_ ? tactile_->grad_embedding() : Buffer<float>(),
                                      object_ ? object_->grad_embedding() : Buffer<float>()});
  input_.target = runtime_.allocate<float>(rows * state_lanes);
  input_.weight = runtime_.allocate<float>(rows);
  loss_ = runtime_.allocate<float>(1);
  const auto row_loss = runtime_.allocate<float>(rows + (object_ ? sequences_ : 0));
  state_loss_ = {state_loss(runtime_, {.sequences = sequences_,
                                       .steps = steps_,
                                       .state = spec_.state,
                                       .band_quantile = static_cast<float>(spec_.band_quantile),
                                       .states = states(),
                                       .spread = spread(),
                                       .target = input_.target,
                                       .weight = input_.weight,
                                       .row_loss = row_loss,
                                       .grad_state = dynamics_->grad_state(),
                                       .grad_spread = dynamics_->grad_spread()})};
  if (object_)
    total_loss_ = info_nce(runtime_, {.count = sequences_,
                                      .columns = spec_.embedding,
                                      .temperature = spec_.contrast_temperature,
                                      .embedding = object_->embedding(),
                                      .object = input_.object,
                                      .weight = input_.contrast_weight,
                                      .row_loss = row_loss,
                                      .row_loss_at = static_cast<int>(rows),
                                      .grad_embedding = object_->grad_embedding()});
  total_loss_.push_back(sum(runtime_, row_loss, loss_));
}

void Model::prepare() {
  enqueue_concurrently([&] { object_->prepare(); },
                       [&] {
                         if (tactile_) tactile_->prepare();
                         enqueue(runtime_, dynamics_->prepare());
                       });
}

void Model::forward(const Buffer<float>& stream, const TaxelDropout& dropout,
                    const TaxelDropout& segment_dropout) {
  enqueue_concurrently([&] { object_->forward(stream, segment_dropout); },
                       [&] {
                         if (tactile_) tactile_->forward(stream, dropout);
                       });
  enqueue(runtime_, dynamics_->forward());
}

void Model::backward() {
  runtime_.fill(weights_->gradient, 0.0f);
  enqueue(runtime_, state_loss_);
  enqueue(runtime_, dynamics_->backward());
  // Now, since the contrastive loss adds to the object embedding gradient that the dynamics writes.
  enqueue(runtime_, total_loss_);
  enqueue_concurrently([&] { object_->backward(); },
                       [&] {
                         if (tactile_) tactile_->backward();
                       });
}

void Model::enqueue_concurrently(const std::function<void()>& object,
                                 const std::function<void()>& others) {
  if (!object_) return others();
  runtime_.fork();
  runtime_.on_side_queue(object);
  others();
  runtime_.join();
}

}  // namespace touchtrace
