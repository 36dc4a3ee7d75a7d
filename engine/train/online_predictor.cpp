#include "engine/train/online_predictor.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "engine/base/error.h"
#include "engine/train/batch_rows.h"
#include "engine/train/model_file.h"
#include "engine/train/object_embedder.h"

namespace touchtrace {
namespace {

void check_argument(const char* what, std::size_t size, std::size_t expected) {
  if (size != expected)
    throw failure(fmt::format("{} of {} values; expected {}", what, size, expected),
                  "see OnlinePredictor for the sizes");
}

}  // namespace

struct OnlinePredictor::Impl {
  Runtime& runtime;
  ModelFile file;
  std::unique_ptr<Model> model;
  std::optional<ObjectEmbedder> embedder;  ///< with an object encoder
  /// [num_slots(), rows, cols] one frame per slot, so that each window is contiguous. When all
  /// slots are used, the frames that the next window shares are copied to the front. Empty without
  /// touch.
  Buffer<float> stream;
  std::int32_t slot;            ///< of the last frame
  std::int32_t window_end = 0;  ///< source of a non-blocking write
  std::array<float, state_lanes> state{};
  std::vector<float> result;  ///< Model::states_and_spread() without the first state
  bool knows_object = false, is_precomputed = false, state_queued = false;

  Impl(Runtime& on, const std::filesystem::path& path)
      : runtime(on),
        file(read_model_file(path)),
        model(file.make(on, 1, 1, Model::Use::prediction)),
        slot(shared_frames() - 1),
        result(model->states_and_spread().size() - state_lanes) {
    if (file.spec.touch) stream = on.allocate_zeros<float>(num_slots() * frame_size());
    if (has_object()) embedder.emplace(on, file.spec, file.file);
  }

  bool has_object() const { return file.spec.object != ObjectEncoder::none; }

  /// Number of frames that consecutive windows share.
  std::int32_t shared_frames() const { return file.spec.window_frames - 1; }
  std::int32_t num_slots() const { return 32 * file.spec.window_frames; }

  std::size_t frame_size() const {
    return file.spec.touch ? std::size_t(file.spec.rows) * file.spec.cols : 0;
  }

  /// Calls `enqueue`, which waits for what it enqueues. If it throws, waits before rethrowing:
  /// pending writes read the caller's frame and this object.
  template <class Enqueue>
  void run(Enqueue enqueue) {
    try {
      enqueue();
    } catch (...) {
      try {
        runtime.finish();
      } catch (const Error&) {
        // The first error says more; a device that fails has stopped reading.
      }
      throw;
    }
  }

  void queue_frame(std::span<const float> frame) {
    if (!file.spec.touch) return;
    free_slot();
    runtime.enqueue_write(stream, frame, (slot + 1) * frame_size());
    ++slot;
  }

  /// Frees the slot for the next frame, after the frames of its window.
  void free_slot() {
    if (slot + 1 < num_slots()) return;
    runtime.enqueue_copy(stream, (num_slots() - shared_frames()) * frame_size(), 0,
                         shared_frames() * frame_size());
    slot = shared_frames() - 1;
  }

  void queue_window(std::int32_t last_slot) {
    window_end = last_slot;
    runtime.enqueue_write(model->input().window_end, std::span(&window_end, 1));
  }

  void queue_state() {
    if (!std::exchange(state_queued, true)) runtime.enqueue_write(model->states(), state);
  }

  void precompute() {
    queue_state();
    if (file.spec.touch && !is_precomputed) {
      free_slot();
      queue_window(slot + 1);
      model->precompute_forward(stream);
      is_precomputed = true;
    }
    runtime.finish();
  }

  void forward() {
    if (std::exchange(is_precomputed, false)) return model->finish_forward(stream);
    if (file.spec.touch) queue_window(slot);
    model->forward(stream);
  }

  void set_embedding(std::span<const float> embedding) {
    const std::int32_t row = 0;
    write_object_embeddings(runtime, *model, std::span(&row, 1), embedding);
    knows_object = true;
  }

  void set_object(std::span<const float> segment) {
    const std::int32_t first = 0;
    set_embedding(embedder->embed(runtime.upload(segment), std::span(&first, 1)));
  }

  void check_object() const {
    if (has_object() && !knows_object)
      throw failure("step() called before set_object()",
                    "a model with an object encoder needs set_object() or set_object_embedding()");
  }

  void step() {
    queue_state();
    forward();
    model->carry_state();
    runtime.read(model->states_and_spread(), std::span<float>(result), state_lanes);
    std::copy_n(result.begin(), state_lanes, state.begin());
    state_queued = false;
  }
};

OnlinePredictor::OnlinePredictor(Runtime& runtime, const std::filesystem::path& model)
    : impl_(std::make_unique<Impl>(runtime, model)) {}

OnlinePredictor::~OnlinePredictor() = default;

const ModelSpec& OnlinePredictor::spec() const { return impl_->file.spec; }
const nlohmann::json& OnlinePredictor::metadata() const { return impl_->file.metadata; }

void OnlinePredictor::set_state(std::span<const float> state) {
  check_argument("state", state.size(), std::size_t(spec().state));
  std::ranges::copy(state, impl_->state.begin());
  impl_->state_queued = false;
  impl_->model->reset_state();
}

void OnlinePredictor::set_object(std::span<const float> segment) {
  check_argument("segment", segment.size(),
                 impl_->has_object() ? spec().segment_frames * impl_->frame_size() : 0);
  if (impl_->has_object()) impl_->set_object(segment);
}

void OnlinePredictor::set_object_embedding(std::span<const float> embedding) {
  check_argument("embedding", embedding.size(),
                 impl_->has_object() ? std::size_t(spec().embedding) : 0);
  if (impl_->has_object()) impl_->set_embedding(embedding);
}

void OnlinePredictor::push(std::span<const float> frame) {
  check_argument("frame", frame.size(), impl_->frame_size());
  impl_->is_precomputed = false;
  impl_->run([&] {
    impl_->queue_frame(frame);
    impl_->runtime.finish();
  });
}

void OnlinePredictor::precompute() {
  impl_->run([&] { impl_->precompute(); });
}

OnlinePredictor::Step OnlinePredictor::step(std::span<const float> frame) {
  check_argument("frame", frame.size(), impl_->frame_size());
  impl_->check_object();
  impl_->run([&] {
    impl_->queue_frame(frame);
    impl_->step();
  });
  const auto size = std::size_t(spec().state);
  return {std::span(impl_->state).first(size),
          std::span(impl_->result).last(state_lanes).first(size)};
}

}  // namespace touchtrace
