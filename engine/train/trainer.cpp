#include "engine/train/trainer.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/model/model.h"
#include "engine/train/batch_rows.h"
#include "engine/train/checkpoint_metadata.h"
#include "engine/train/update_loop.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

/// Names the first input of a batch that is not finite; empty if none is. Labels of weight 0 do
/// not count.
std::string invalid_input(const RolloutBatch& batch) {
  if (!all_finite(batch.initial_state)) return "the initial states";
  if (!all_finite(batch.weight)) return "the label weights";
  const auto size = batch.target.size() / (std::size_t(batch.sequences) * batch.steps);
  for (std::size_t i = 0; i * size < batch.target.size(); ++i)
    if ((batch.weight.empty() || batch.weight[i] != 0.0f) &&
        !all_finite(std::span(batch.target).subspan(i * size, size)))
      return "the labels";
  return {};
}

std::size_t taxels_of(const ModelSpec& spec) {
  validate(spec);
  return std::size_t(spec.rows) * spec.cols;
}

}  // namespace

struct Trainer::Impl {
  Runtime& runtime;
  TrainOptions options;
  std::size_t frames;
  Model model;
  UpdateLoop loop;
  FrozenObjects objects;

  Impl(Runtime& on, const ModelSpec& spec, const TrainOptions& train_options, int sequences,
       int steps, std::span<const float> tactile)
      : runtime(on),
        options(train_options),
        frames(tactile.size() / taxels_of(spec)),
        model(on, spec, sequences, steps, Model::Use::training,
              live_taxels(tactile, taxels_of(spec))),
        loop(on, train_options, model.weights(), model.loss(), {"update", "taxel drop-out"},
             spec.touch ? tactile : std::span<const float>()) {}

  void upload(const RolloutBatch& batch) {
    if (batch.sequences != model.sequences() || batch.steps != model.steps() ||
        batch.target.empty())
      throw failure(fmt::format("batch of {} x {} with {} targets; the trainer expects {} x {}",
                                batch.sequences, batch.steps, batch.target.size(),
                                model.sequences(), model.steps()),
                    "report this as a bug");
    check(batch, model.spec(), frames);
    check_objects(batch, model.spec(), frames, Model::Use::training);
    write_windows(runtime, model, batch);
    write_initial_states(runtime, model, {batch}, batch.initial_state);
    write_targets(runtime, model, batch);
    write_segments(runtime, model, batch, options.object_loss);
    if (model.spec().object == ObjectEncoder::frozen)
      write_object_embeddings(runtime, model, batch.object, objects.embedding);
  }

  void pass(const UpdateLoop::Keys& keys) {
    model.prepare();
    model.forward(loop.stream(), {options.taxel_dropout, keys[0]},
                  {options.taxel_dropout, keys[1]});
    model.backward();
  }

  /// Weights of the model, and of the object encoder if that is frozen.
  std::vector<Tensor> weight_tensors() const {
    auto tensors = tensors_of(model.table(), runtime.download(model.weights().values));
    std::ranges::copy(objects.encoder, std::back_inserter(tensors));
    return tensors;
  }
};

Trainer::Trainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options,
                 int sequences, int steps, std::span<const float> tactile)
    : impl_(std::make_unique<Impl>(runtime, spec, options, sequences, steps, tactile)) {}

Trainer::~Trainer() = default;

double Trainer::update(const RolloutBatch& batch) {
  impl_->upload(batch);
  return impl_->loop.update({[&](const UpdateLoop::Keys& keys) { impl_->pass(keys); },
                             [&] { return invalid_input(batch); }});
}

void Trainer::freeze_objects(FrozenObjects objects) { impl_->objects = std::move(objects); }

int Trainer::updates() const { return impl_->loop.counts().attempted; }

TensorFile Trainer::model_file(const nlohmann::json& metadata) const {
  return {{{"format", "touchtrace/model/1"},
           {"spec", nlohmann::json(impl_->model.spec()).dump()},
           {"metadata", metadata.dump()}},
          impl_->weight_tensors()};
}

void Trainer::save(const std::filesystem::path& path, const nlohmann::json& metadata,
                   bool overwrite) const {
  write_safetensors(path, model_file(metadata), overwrite);
}

void Trainer::save_checkpoint(const std::filesystem::path& path, const nlohmann::json& notes,
                              const std::vector<Tensor>& tensors) const {
  TensorFile file{to_metadata({impl_->model.spec(), impl_->loop.counts(), notes}),
                  impl_->weight_tensors()};
  for (const auto& [name, array] : impl_->loop.optimiser_state())
    file.tensors.push_back({name, {array.size()}, impl_->runtime.download(array)});
  std::ranges::copy(tensors, std::back_inserter(file.tensors));
  write_safetensors(path, file, true);
}

void Trainer::load_checkpoint(const std::filesystem::path& path) {
  const auto file = read_safetensors(path);
  const auto checkpoint = checkpoint_metadata(file, path);
  check_resumable(checkpoint, impl_->model.spec(), path);
  // Everything is read before anything is written.
  std::vector<std::pair<Buffer<float>, std::vector<float>>> writes;
  writes.emplace_back(impl_->model.weights().values, values_of(impl_->model.table(), file));
  for (const auto& [name, array] : impl_->loop.optimiser_state())
    writes.emplace_back(array, file.at(name, array.size()).values);
  for (const auto& [array, values] : writes) impl_->runtime.write<float>(array, values);
  impl_->loop.resume(checkpoint.counts);
}

nlohmann::json Trainer::checkpoint_notes(const std::filesystem::path& path) {
  return checkpoint_metadata(read_safetensors(path), path).notes;
}

}  // namespace touchtrace
