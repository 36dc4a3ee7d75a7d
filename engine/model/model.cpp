#include "engine/model/model.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

/// The same error, saying what the device was to hold.
Error while_making(const ModelSpec& spec, int sequences, int steps, const Error& error) {
  const auto windows = spec.touch ? fmt::format(" with windows of {} x {} x {}", spec.window_frames,
                                                spec.rows, spec.cols)
                                  : "";
  return Error(error.code(),
               fmt::format("a model for {} sequences of {} steps{}: {}", sequences, steps, windows,
                           error.what()),
               error.remedy());
}

/// Puts the operations that are small, and needed by every model, into one program.
void bundle_programs(Runtime& runtime, const ModelSpec& spec, Model::Use use) {
  std::vector<std::string> files{"common.clh",   "tile.clh",   "dense.cl",
                                 "dynamics.clh", "rollout.cl", "rollout_backward.cl"};
  Defines defines{{"HIDDEN", std::to_string(spec.hidden)}, {"STATE", std::to_string(spec.state)}};
  if (use == Model::Use::training) files.insert(files.end(), {"state_loss.cl", "adam.cl"});
  if (spec.touch) {
    files.push_back("layer_norm.cl");
    defines["COLUMNS"] = std::to_string(spec.embedding);
  }
  runtime.bundle(std::move(files), std::move(defines));
}

}  // namespace

Model::Model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps, Use use) try
    : runtime_(runtime), spec_(spec), sequences_(sequences), steps_(steps) {
  validate(spec);
  bundle_programs(runtime, spec, use);
  const bool training = use == Use::training;
  const int rows = sequences * steps;
  if (spec.touch) {
    encoder_ = std::make_unique<TactileEncoder>(
        runtime, "tactile", TactileWindowShape{rows, spec.window_frames, spec.rows, spec.cols},
        training, table_);
    TouchEmbedding::declare(spec, encoder_->feature_size(), table_);
    input_.last_frame = runtime.allocate<std::int32_t>(rows);
  }
  DynamicsMlp::declare(spec, table_);
  weights_ = std::make_unique<Weights>(
      Weights{table_, runtime.allocate<float>(table_.size()),
              training ? runtime.allocate<float>(table_.size()) : Buffer<float>()});
  if (spec.touch)
    touch_ = std::make_unique<TouchEmbedding>(runtime, spec, *weights_, encoder_->features(), rows);
  dynamics_ = std::make_unique<DynamicsMlp>(
      runtime, spec, *weights_, touch_ ? touch_->embedding() : Buffer<float>(), sequences, steps);
  if (training) plan_loss();
} catch (const Error& error) {
  if (error.code() != ExitCode::no_device) throw;
  throw while_making(spec, sequences, steps, error);
}

void Model::plan_loss() {
  const auto rows = static_cast<std::size_t>(sequences_) * steps_;
  dynamics_->plan_backward(runtime_, touch_ ? touch_->grad_embedding() : Buffer<float>());
  input_.target = runtime_.allocate<float>(rows * state_lanes);
  input_.weight = runtime_.allocate<float>(rows);
  loss_ = runtime_.allocate<float>(1);
  loss_launches_ = state_loss(runtime_, {.sequences = sequences_,
                                         .steps = steps_,
                                         .state = spec_.state,
                                         .states = states(),
                                         .spread = spread(),
                                         .target = input_.target,
                                         .weight = input_.weight,
                                         .row_loss = runtime_.allocate<float>(rows),
                                         .total = loss_,
                                         .grad_state = dynamics_->gradients().grad_state,
                                         .grad_spread = dynamics_->gradients().grad_spread});
}

void Model::prepare() {
  if (touch_) enqueue(runtime_, touch_->prepare());
  enqueue(runtime_, dynamics_->prepare());
}

void Model::forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
  if (touch_) {
    encoder_->forward(stream, input_.last_frame, weights_->values, dropout);
    enqueue(runtime_, touch_->forward());
  }
  enqueue(runtime_, dynamics_->forward());
}

void Model::backward() {
  const auto& gradient = weights_->gradient;
  runtime_.fill(gradient, 0.0f);
  enqueue(runtime_, loss_launches_);
  enqueue(runtime_, dynamics_->backward());
  if (!touch_) return;
  enqueue(runtime_, touch_->backward());
  encoder_->backward(touch_->grad_features(), gradient);
}

}  // namespace touchtrace
