#include "engine/train/predictor.h"

#include <algorithm>
#include <optional>

#include "engine/train/batch_rows.h"
#include "engine/train/model_file.h"
#include "engine/train/segment_rows.h"
#include "engine/train/tactile_embedder.h"

namespace touchtrace {
namespace {

// Maximum size of a block of roll-outs on the device; bounds memory.
constexpr int max_sequences = 32, max_steps = 20;

}  // namespace

struct Predictor::Impl {
  Runtime& runtime;
  ModelFile file;
  std::unique_ptr<Model> model;
  std::optional<TactileEmbedder> touch, object;

  Impl(Runtime& on, TensorFile model_file)
      : runtime(on), file(parse_model_file(std::move(model_file))) {
    resize(1, 1);  // reads the weights, so that an incomplete file fails now
    if (file.spec.touch) touch.emplace(on, "tactile", file.spec, file.file);
    if (file.spec.object != ObjectEncoder::none) object.emplace(on, "object", file.spec, file.file);
  }

  /// Makes the model take this many sequences and steps.
  void resize(int sequences, int steps) {
    if (model && model->sequences() == sequences && model->steps() == steps) return;
    model = file.make(runtime, sequences, steps, Model::Use::rollout);
  }

  struct Embedded {
    DistinctEmbeddings steps;    ///< g_t, [S, T]
    DistinctEmbeddings objects;  ///< e_i, [S]
  };

  Embedded embed(const RolloutBatch& batch, std::span<const float> tactile) {
    Embedded embedded;
    if (!touch && !object) return embedded;
    const auto stream = runtime.upload(tactile);
    if (touch) {
      std::vector<std::int32_t> window_end;
      for (const auto first : batch.first_frame)
        for (int t = 0; t < batch.steps; ++t) window_end.push_back(first + t);
      embedded.steps = touch->embed_distinct(tactile, stream, window_end);
    }
    if (object)
      embedded.objects =
          object->embed_distinct(tactile, stream, segment_ends(file.spec, batch.segment_frame));
    return embedded;
  }

  /// Rolls out the block's sequences to the last step and writes them to `rollout`.
  void predict(BatchBlock block, const Embedded& embedded, Rollout& rollout) {
    std::vector<float> state = block.batch.initial_state;
    if (object) write_object_embeddings(runtime, *model, block, embedded.objects);
    model->reset_state();
    for (; block.first_step < block.batch.steps; block.first_step += model->steps()) {
      if (touch) write_tactile_embeddings(runtime, *model, block, embedded.steps);
      write_initial_states(runtime, *model, block, state);
      model->forward({});
      model->carry_state();
      collect(block, rollout);
      const int last = std::min(block.first_step + model->steps(), block.batch.steps) - 1;
      for (int s = 0; s < block.batch.sequences; ++s)
        std::copy_n(rollout.state.begin() +
                        (std::ptrdiff_t(s) * block.batch.steps + last) * file.spec.state,
                    file.spec.state, state.begin() + std::ptrdiff_t(s) * file.spec.state);
    }
  }

  void collect(const BatchBlock& block, Rollout& rollout) {
    const auto states = runtime.download(model->states()),
               spread = runtime.download(model->spread());
    const int sequences =
        std::min(model->sequences(), block.batch.sequences - block.first_sequence);
    const int steps = std::min(model->steps(), block.batch.steps - block.first_step);
    for (int t = 0; t < steps; ++t)
      for (int s = 0; s < sequences; ++s) {
        const std::ptrdiff_t row = std::ptrdiff_t(t) * model->sequences() + s;
        const std::ptrdiff_t to =
            (std::ptrdiff_t(block.first_sequence + s) * block.batch.steps + block.first_step + t) *
            file.spec.state;
        std::copy_n(states.begin() + (row + model->sequences()) * state_lanes, file.spec.state,
                    rollout.state.begin() + to);
        std::copy_n(spread.begin() + row * state_lanes, file.spec.state,
                    rollout.spread.begin() + to);
      }
  }
};

Predictor::Predictor(Runtime& runtime, TensorFile model)
    : impl_(std::make_unique<Impl>(runtime, std::move(model))) {}

Predictor::Predictor(Runtime& runtime, const std::filesystem::path& model)
    : Predictor(runtime, read_safetensors(model)) {}

Predictor::~Predictor() = default;

const ModelSpec& Predictor::spec() const { return impl_->file.spec; }
const nlohmann::json& Predictor::metadata() const { return impl_->file.metadata; }

Rollout Predictor::predict(const RolloutBatch& batch, std::span<const float> tactile) {
  const auto& spec = impl_->file.spec;
  const std::size_t frames = tactile.size() / (std::size_t(spec.rows) * spec.cols);
  check(batch, spec, frames);
  check_objects(batch, spec, frames, Model::Use::prediction);
  const auto values = std::size_t(batch.sequences) * batch.steps * spec.state;
  Rollout rollout{std::vector<float>(values), std::vector<float>(values)};
  if (values == 0) return rollout;
  impl_->resize(std::min(batch.sequences, max_sequences), std::min(batch.steps, max_steps));
  const auto embedded = impl_->embed(batch, tactile);
  for (int s = 0; s < batch.sequences; s += impl_->model->sequences())
    impl_->predict({batch, s, 0}, embedded, rollout);
  return rollout;
}

}  // namespace touchtrace
