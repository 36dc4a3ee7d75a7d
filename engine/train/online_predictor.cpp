#include "engine/train/online_predictor.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

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
  std::vector<float> window;               ///< [M, rows, cols] last frames; empty without touch
  Buffer<float> stream;                    ///< the same on the device
  std::array<float, state_lanes> state{};
  std::vector<float> result;  ///< Model::states_and_spread() without the first state
  bool knows_object = false;

  Impl(Runtime& on, const std::filesystem::path& path)
      : runtime(on),
        file(read_model_file(path)),
        model(file.make(on, 1, 1, Model::Use::prediction)),
        result(model->states_and_spread().size() - state_lanes) {
    if (file.spec.touch) plan_window();
    if (has_object()) embedder.emplace(on, file.spec, file.file);
  }

  bool has_object() const { return file.spec.object != ObjectEncoder::none; }

  std::size_t frame_size() const {
    return file.spec.touch ? std::size_t(file.spec.rows) * file.spec.cols : 0;
  }

  /// Calls `enqueue`, which waits for what it enqueues. If it throws, waits before rethrowing:
  /// pending writes read this object.
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

  void plan_window() {
    const std::int32_t last_frame = file.spec.window_frames - 1;
    window.resize(std::size_t(file.spec.window_frames) * frame_size());
    stream = runtime.allocate<float>(window.size());
    runtime.write<std::int32_t>(model->input().window_end, std::span(&last_frame, 1));
  }

  void push(std::span<const float> frame) {
    std::ranges::copy(std::span(window).subspan(frame.size()), window.begin());
    std::ranges::copy(frame, window.end() - static_cast<std::ptrdiff_t>(frame.size()));
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
    runtime.enqueue_write(model->states(), state);
    if (file.spec.touch) runtime.enqueue_write(stream, std::span<const float>(window));
    model->forward(stream);
    model->carry_state();
    runtime.read(model->states_and_spread(), std::span<float>(result), state_lanes);
    std::copy_n(result.begin(), state_lanes, state.begin());
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
  impl_->push(frame);
}

OnlinePredictor::Step OnlinePredictor::step(std::span<const float> frame) {
  check_argument("frame", frame.size(), impl_->frame_size());
  impl_->check_object();
  impl_->push(frame);
  impl_->run([&] { impl_->step(); });
  const auto size = std::size_t(spec().state);
  return {std::span(impl_->state).first(size),
          std::span(impl_->result).last(state_lanes).first(size)};
}

}  // namespace touchtrace
