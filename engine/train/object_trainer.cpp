#include "engine/train/object_trainer.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/cl/launch_inspection.h"
#include "engine/model/object_model.h"
#include "engine/ops/adam.h"
#include "engine/train/schedule.h"
#include "engine/train/segment_rows.h"
#include "engine/train/weight_file.h"

namespace touchtrace {

struct ObjectTrainer::Plan {
  Runtime& runtime;
  ModelSpec spec;
  TrainOptions options;
  ObjectModel model;
  Adam adam;
  std::size_t frames;
  Buffer<float> stream;
  RandomStream dropout_keys;
  int updates = 0;

  Plan(Runtime& on, const ModelSpec& wanted, const TrainOptions& how, int segments,
       std::span<const float> tactile, const Tuning& tuning)
      : runtime(on),
        spec(wanted),
        options(how),
        model(on, wanted, segments, tuning),
        adam(on, model.weights().values, model.weights().gradient,
             decays(on, model.table(), how.weight_decay), model.loss()),
        frames(tactile.size() / (std::size_t(wanted.rows) * wanted.cols)),
        stream(on.upload(tactile)),
        dropout_keys(how.seed, "taxel drop-out of segments") {
    runtime.write<float>(model.weights().values, model.table().initial_values(how.seed));
  }

  void upload(const SegmentBatch& batch) {
    const auto count = std::size_t(model.segments());
    if (batch.first_frame.size() != count || batch.object.size() != count)
      throw failure(fmt::format("{} segments of {} objects were given to a trainer of {}",
                                batch.first_frame.size(), batch.object.size(), count),
                    "report this as a bug");
    check_segments(spec, batch.first_frame, frames);
    runtime.write<std::int32_t>(model.last_frame(), segment_last_frames(spec, batch.first_frame));
    runtime.write<std::int32_t>(model.object(), batch.object);
    runtime.write<float>(model.weight(), contrast_weights(batch.object, 1.0));
  }

  void pass() {
    const auto number = static_cast<std::uint64_t>(updates);
    model.prepare();
    model.forward(stream, {options.taxel_dropout, dropout_keys.block(number)[0]});
    model.backward();
  }

  double step() {
    pass();
    adam.enqueue({updates + 1, learning_rate(options, updates), options.clip_norm});
    const float loss = runtime.download(model.loss())[0], norm = runtime.download(adam.norm())[0];
    if (!std::isfinite(loss) || !std::isfinite(norm))
      throw failure(fmt::format("update {} of the object encoder is not finite, first what {} "
                                "computes",
                                updates + 1, first_non_finite_kernel(runtime, [&] { pass(); })),
                    "lower --learning-rate, or look for extreme values in the tactile frames");
    ++updates;
    return loss;
  }
};

ObjectTrainer::ObjectTrainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options,
                             int segments, std::span<const float> tactile, const Tuning& tuning)
    : plan_(std::make_unique<Plan>(runtime, spec, options, segments, tactile, tuning)) {}

ObjectTrainer::~ObjectTrainer() = default;

double ObjectTrainer::update(const SegmentBatch& batch) {
  plan_->upload(batch);
  return plan_->step();
}

int ObjectTrainer::updates() const { return plan_->updates; }

std::vector<Tensor> ObjectTrainer::weights() const {
  return tensors_of(plan_->model.table(), plan_->runtime.download(plan_->model.weights().values));
}

}  // namespace touchtrace
