#include "engine/train/trainer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/cl/launch_inspection.h"
#include "engine/model/model.h"
#include "engine/ops/adam.h"
#include "engine/train/batch_rows.h"
#include "engine/train/checkpoint_metadata.h"
#include "engine/train/schedule.h"
#include "engine/train/tuning_json.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

bool all_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float v) { return std::isfinite(v); });
}

/// The first part of a batch that is not finite; empty if all is. Labels of weight 0 do not count.
std::string not_finite_part(const RolloutBatch& batch) {
  if (!all_finite(batch.initial_state)) return "the initial states";
  if (!all_finite(batch.weight)) return "the labels' weights";
  const auto size = batch.target.size() / (std::size_t(batch.sequences) * batch.steps);
  for (std::size_t i = 0; i * size < batch.target.size(); ++i)
    if ((batch.weight.empty() || batch.weight[i] != 0.0f) &&
        !all_finite(std::span(batch.target).subspan(i * size, size)))
      return "the labels";
  return {};
}

}  // namespace

struct Trainer::Plan {
  Runtime& runtime;
  TrainOptions options;
  Tuning tuning;
  Model model;
  Adam adam;
  std::size_t frames;
  Buffer<float> stream;
  RandomStream dropout_keys;
  FrozenObjects objects;
  UpdateCounts counts;

  Plan(Runtime& on, const ModelSpec& spec, const TrainOptions& wanted, int sequences, int steps,
       std::span<const float> tactile, const Tuning& choices)
      : runtime(on),
        options(wanted),
        tuning(choices),
        model(on, spec, sequences, steps, Model::Use::training,
              live_taxels(tactile, std::size_t(spec.rows) * spec.cols), choices),
        adam(on, model.weights().values, model.weights().gradient,
             decays(on, model.table(), wanted.weight_decay), model.loss()),
        frames(tactile.size() / (std::size_t(spec.rows) * spec.cols)),
        dropout_keys(wanted.seed, "taxel drop-out") {
    if (spec.touch) stream = runtime.upload(tactile);
    runtime.write<float>(model.weights().values, model.table().initial_values(wanted.seed));
  }

  void upload(const RolloutBatch& batch) {
    if (batch.sequences != model.sequences() || batch.steps != model.steps() ||
        batch.target.empty())
      throw failure(fmt::format("a batch of {} x {} was given to a trainer of {} x {}",
                                batch.sequences, batch.steps, model.sequences(), model.steps()),
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

  void pass() {
    const auto number = static_cast<std::uint64_t>(counts.tried);
    model.prepare();
    const auto keys = dropout_keys.block(number);
    model.forward(stream, {options.taxel_dropout, keys[0]}, {options.taxel_dropout, keys[1]});
    model.backward();
  }

  double step(const RolloutBatch& batch) {
    pass();
    adam.enqueue({counts.tried - counts.left_out + 1, learning_rate(options, counts.tried),
                  options.clip_norm});
    const float loss = runtime.download(model.loss())[0], norm = runtime.download(adam.norm())[0];
    if (!std::isfinite(loss) || !std::isfinite(norm)) return leave_out(batch);
    ++counts.tried;
    counts.left_out_in_a_row = 0;
    return loss;
  }

  /// After an update that changed nothing, since it was not finite.
  double leave_out(const RolloutBatch& batch) {
    const auto problem = fmt::format("update {}: {} not finite", counts.tried + 1, culprit(batch));
    if (counts.left_out_in_a_row >= options.skips_in_a_row)
      throw failure(problem,
                    "lower --learning-rate, look for extreme values in labels and tactile frames, "
                    "or leave such updates out with --skip-not-finite; the weights are those "
                    "before this update");
    fmt::print(stderr, "warning: {}; it is left out\n", problem);
    ++counts.tried, ++counts.left_out, ++counts.left_out_in_a_row;
    return std::nan("");
  }

  std::string culprit(const RolloutBatch& batch) {
    if (const auto part = not_finite_part(batch); !part.empty()) return part + " are";
    if (!all_finite(runtime.download(model.weights().values))) return "the weights are";
    if (stream.size() > 0 && !all_finite(runtime.download(stream))) return "the tactile frames are";
    const auto name = first_non_finite_kernel(runtime, [&] { pass(); });
    return name.empty() ? "the gradient's norm is" : fmt::format("what {} computes is", name);
  }
};

Trainer::Trainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options,
                 int sequences, int steps, std::span<const float> tactile, const Tuning& tuning)
    : plan_(std::make_unique<Plan>(runtime, spec, options, sequences, steps, tactile, tuning)) {}

Trainer::~Trainer() = default;

double Trainer::update(const RolloutBatch& batch) {
  plan_->upload(batch);
  return plan_->step(batch);
}

void Trainer::freeze_objects(FrozenObjects objects) { plan_->objects = std::move(objects); }

int Trainer::updates() const { return plan_->counts.tried; }

void Trainer::save(const std::filesystem::path& path, const nlohmann::json& metadata,
                   bool overwrite) const {
  const auto& model = plan_->model;
  auto tensors = tensors_of(model.table(), plan_->runtime.download(model.weights().values));
  std::ranges::copy(plan_->objects.encoder, std::back_inserter(tensors));
  write_safetensors(path,
                    {{{"format", "touchtrace/model/1"},
                      {"spec", nlohmann::json(model.spec()).dump()},
                      {"metadata", metadata.dump()}},
                     std::move(tensors)},
                    overwrite);
}

void Trainer::save_checkpoint(const std::filesystem::path& path,
                              const nlohmann::json& notes) const {
  const auto& model = plan_->model;
  const auto read = [&](const Buffer<float>& buffer) { return plan_->runtime.download(buffer); };
  auto tensors = tensors_of(model.table(), read(model.weights().values));
  for (const auto& [name, array] : plan_->adam.state())
    tensors.push_back({name, {array.size()}, read(array)});
  std::ranges::copy(plan_->objects.encoder, std::back_inserter(tensors));
  write_safetensors(
      path, {to_metadata(model.spec(), {plan_->counts, plan_->tuning, notes}), std::move(tensors)},
      true);
}

void Trainer::load_checkpoint(const std::filesystem::path& path) {
  const auto file = read_safetensors(path);
  const auto checkpoint = checkpoint_metadata(file, path);
  if (nlohmann::json(checkpoint.tuning) != nlohmann::json(plan_->tuning))
    throw data_error(path.string() + " was started with other choices of touchtrace tune",
                     "go on with those that the checkpoint holds");
  const auto values = values_of(plan_->model.table(), file);
  const auto state = plan_->adam.state();
  for (const auto& [name, array] : state)
    file.at(name, array.size());  // throws before any is written
  for (const auto& [name, array] : state)
    plan_->runtime.write<float>(array, file.at(name, array.size()).values);
  plan_->runtime.write<float>(plan_->model.weights().values, values);
  plan_->counts = checkpoint.counts;
}

nlohmann::json Trainer::checkpoint_notes(const std::filesystem::path& path) {
  return checkpoint_metadata(read_safetensors(path), path).notes;
}

Tuning Trainer::checkpoint_tuning(const std::filesystem::path& path) {
  return checkpoint_metadata(read_safetensors(path), path).tuning;
}

}  // namespace touchtrace
