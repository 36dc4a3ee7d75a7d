#include "engine/train/object_trainer.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/model/object_model.h"
#include "engine/train/segment_rows.h"
#include "engine/train/update_loop.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

TrainOptions without_skips(TrainOptions options) {
  options.max_consecutive_skips = 0;
  return options;
}

}  // namespace

struct ObjectTrainer::Impl {
  Runtime& runtime;
  ModelSpec spec;
  double taxel_dropout;
  ObjectModel model;
  std::size_t frames;
  UpdateLoop loop;

  Impl(Runtime& on, const ModelSpec& model_spec, const TrainOptions& options, int segments,
       std::span<const float> tactile)
      : runtime(on),
        spec(model_spec),
        taxel_dropout(options.taxel_dropout),
        model(on, model_spec, segments),
        frames(tactile.size() / (std::size_t(model_spec.rows) * model_spec.cols)),
        loop(on, without_skips(options), model.weights(), model.loss(),
             {"object encoder update", "taxel drop-out of segments"}, tactile) {}

  void upload(const SegmentBatch& batch) {
    const auto count = std::size_t(model.segments());
    if (batch.first_frame.size() != count || batch.object.size() != count)
      throw failure(fmt::format("batch of {} segments with {} objects; the trainer expects {}",
                                batch.first_frame.size(), batch.object.size(), count),
                    "report this as a bug");
    check_segments(spec, batch.first_frame, frames);
    runtime.write<std::int32_t>(model.window_end(), segment_ends(spec, batch.first_frame));
    runtime.write<std::int32_t>(model.object(), batch.object);
    runtime.write<float>(model.weight(), contrast_weights(batch.object, 1.0));
  }

  void pass(const UpdateLoop::Keys& keys) {
    model.prepare();
    model.forward(loop.stream(), {taxel_dropout, keys[0]});
    model.backward();
  }
};

ObjectTrainer::ObjectTrainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options,
                             int segments, std::span<const float> tactile)
    : impl_(std::make_unique<Impl>(runtime, spec, options, segments, tactile)) {}

ObjectTrainer::~ObjectTrainer() = default;

double ObjectTrainer::update(const SegmentBatch& batch) {
  impl_->upload(batch);
  return impl_->loop.update(
      {[&](const UpdateLoop::Keys& keys) { impl_->pass(keys); }, [] { return std::string(); }});
}

int ObjectTrainer::updates() const { return impl_->loop.counts().attempted; }

std::vector<Tensor> ObjectTrainer::weights() const {
  return tensors_of(impl_->model.table(), impl_->runtime.download(impl_->model.weights().values));
}

}  // namespace touchtrace
