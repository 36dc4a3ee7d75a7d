#include "engine/train/online_predictor.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/error.h"
#include "engine/train/batch_rows.h"
#include "engine/train/model_file.h"
#include "engine/train/object_embedder.h"

namespace touchtrace {

struct OnlinePredictor::Plan {
  Runtime& runtime;
  ModelFile file;
  std::unique_ptr<Model> model;
  /// [slots(), rows, cols], a frame in each slot, so that every window is one piece; at the end the
  /// frames that the next window shares go back to the beginning. Empty without touch.
  Buffer<float> stream;
  std::int32_t slot;            ///< of the last frame given
  std::int32_t last_frame = 0;  ///< of the window that is asked for
  std::array<float, state_lanes> state{};
  std::vector<float> outcome;  ///< of the model but for its first state: a state, ..., a spread
  bool knows_object = false, worked_ahead = false, state_queued = false;

  Plan(Runtime& on, const std::filesystem::path& path)
      : runtime(on),
        file(read_model_file(path)),
        model(file.make(on, 1, 1, Model::Use::prediction)),
        slot(shared_frames() - 1),
        outcome(model->outcome().size() - state_lanes) {
    if (file.spec.touch) stream = on.allocate_zeros<float>(slots() * frame_size());
  }

  /// Of a window and the next one.
  std::int32_t shared_frames() const { return file.spec.window_frames - 1; }
  std::int32_t slots() const { return 32 * file.spec.window_frames; }

  std::size_t frame_size() const {
    return file.spec.touch ? std::size_t(file.spec.rows) * file.spec.cols : 0;
  }

  void check(const char* what, std::size_t size, std::size_t expected) const {
    if (size != expected)
      throw failure(fmt::format("a {} of {} values was given instead of {}", what, size, expected),
                    "report this as a bug");
  }

  void queue_frame(std::span<const float> frame) {
    check("frame", frame.size(), frame_size());
    if (!file.spec.touch) return;
    make_room();
    runtime.enqueue_write(stream, frame, ++slot * frame_size());
  }

  /// For the next frame, behind those of its window.
  void make_room() {
    if (slot + 1 < slots()) return;
    runtime.enqueue_copy(stream, (slots() - shared_frames()) * frame_size(), 0,
                         shared_frames() * frame_size());
    slot = shared_frames() - 1;
  }

  /// The window that ends at a slot.
  void queue_window(std::int32_t last_slot) {
    last_frame = last_slot;
    runtime.enqueue_write(model->input().last_frame, std::span(&last_frame, 1));
  }

  void queue_state() {
    if (!std::exchange(state_queued, true)) runtime.enqueue_write(model->states(), state);
  }

  void work_ahead() {
    queue_state();
    if (file.spec.touch && !worked_ahead) {
      make_room();
      queue_window(slot + 1);
      model->forward_early(stream);
      worked_ahead = true;
    }
    runtime.finish();
  }

  void forward() {
    if (std::exchange(worked_ahead, false)) return model->forward_late(stream);
    if (file.spec.touch) queue_window(slot);
    model->forward(stream);
  }

  void set_object(std::span<const float> segment) {
    const std::int32_t first = 0;
    ObjectEmbedder embedder(runtime, file.spec, file.file);
    write_object_embeddings(runtime, *model, std::span(&first, 1),
                            embedder.embed(runtime.upload(segment), std::span(&first, 1)));
    knows_object = true;
  }

  void step() {
    if (file.spec.object != ObjectEncoder::none && !knows_object)
      throw failure(
          "a model with an object encoder was asked for a step before it was shown an object",
          "call set_object first");
    queue_state();
    forward();
    model->continue_rollouts();
    runtime.read(model->outcome(), std::span<float>(outcome), state_lanes);
    std::copy_n(outcome.begin(), state_lanes, state.begin());
    state_queued = false;
  }
};

OnlinePredictor::OnlinePredictor(Runtime& runtime, const std::filesystem::path& model)
    : plan_(std::make_unique<Plan>(runtime, model)) {}

OnlinePredictor::~OnlinePredictor() = default;

const ModelSpec& OnlinePredictor::spec() const { return plan_->file.spec; }
const nlohmann::json& OnlinePredictor::metadata() const { return plan_->file.metadata; }

void OnlinePredictor::set_state(std::span<const float> state) {
  plan_->check("state", state.size(), std::size_t(spec().state));
  std::ranges::copy(state, plan_->state.begin());
  plan_->state_queued = false;
  plan_->model->begin_rollouts();
}

void OnlinePredictor::set_object(std::span<const float> segment) {
  const auto size = spec().segment_frames * plan_->frame_size();
  plan_->check("segment", segment.size(), size);
  plan_->set_object(segment);
}

void OnlinePredictor::push(std::span<const float> frame) {
  plan_->queue_frame(frame);
  plan_->worked_ahead = false;
  plan_->runtime.finish();
}

void OnlinePredictor::work_ahead() { plan_->work_ahead(); }

OnlinePredictor::Step OnlinePredictor::step(std::span<const float> frame) {
  plan_->queue_frame(frame);
  plan_->step();
  const auto size = std::size_t(spec().state);
  return {std::span(plan_->state).first(size),
          std::span(plan_->outcome).last(state_lanes).first(size)};
}

}  // namespace touchtrace
