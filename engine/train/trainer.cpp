#include "engine/train/trainer.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/model/model.h"
#include "engine/ops/adam.h"
#include "engine/train/batch_rows.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

constexpr const char* checkpoint_format = "touchtrace/checkpoint/1";
constexpr const char* first_moment_name = "adam.first_moment";
constexpr const char* second_moment_name = "adam.second_moment";

/// Weight decay of each parameter: of matrices and convolutions, not of biases and gains.
Buffer<float> decays(Runtime& runtime, const ParameterTable& table, double weight_decay) {
  std::vector<float> decay(table.size(), 0.0f);
  for (const auto& row : table.rows())
    if (row.shape.size() >= 2)
      std::fill_n(decay.begin() + static_cast<std::ptrdiff_t>(row.offset), row.size,
                  static_cast<float>(weight_decay));
  return runtime.upload<float>(decay);
}

/// From `options.learning_rate` to 0 by a half cosine.
double learning_rate(const TrainOptions& options, int update) {
  const double done = std::min(1.0, static_cast<double>(update) / options.updates);
  return 0.5 * options.learning_rate * (1.0 + std::cos(std::numbers::pi * done));
}

/// Negative if the file is no checkpoint.
int updates_of(const TensorFile& file) {
  const auto format = file.metadata.find("format"), updates = file.metadata.find("updates");
  if (format == file.metadata.end() || format->second != checkpoint_format ||
      updates == file.metadata.end())
    return -1;
  int count = -1;
  const auto& text = updates->second;
  const auto end = text.data() + text.size();
  return std::from_chars(text.data(), end, count).ptr == end ? count : -1;
}

}  // namespace

struct Trainer::Plan {
  Runtime& runtime;
  TrainOptions options;
  Model model;
  Adam adam;
  std::size_t frames;
  Buffer<float> stream;
  RandomStream dropout_keys;
  int updates = 0;

  Plan(Runtime& on, const ModelSpec& spec, const TrainOptions& wanted, int sequences, int steps,
       std::span<const float> tactile)
      : runtime(on),
        options(wanted),
        model(on, spec, sequences, steps, Model::Use::training),
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
    write_windows(runtime, model, {batch}, frames);
    write_initial_states(runtime, model, {batch}, batch.initial_state);
    write_targets(runtime, model, batch);
  }

  double step() {
    const std::uint32_t key = dropout_keys.block(static_cast<std::uint64_t>(updates))[0];
    model.prepare();
    model.forward(stream, {options.taxel_dropout, key});
    model.backward();
    adam.enqueue({updates + 1, learning_rate(options, updates), options.clip_norm});
    const float loss = runtime.download(model.loss())[0], norm = runtime.download(adam.norm())[0];
    if (!std::isfinite(loss) || !std::isfinite(norm))
      throw failure(fmt::format("update {}: {} hold a value that is not finite", updates + 1,
                                model.first_not_finite()),
                    "lower the learning rate, or look for extreme values in the labels and the "
                    "tactile frames; the weights are those before this update");
    ++updates;
    return loss;
  }
};

Trainer::Trainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options,
                 int sequences, int steps, std::span<const float> tactile)
    : plan_(std::make_unique<Plan>(runtime, spec, options, sequences, steps, tactile)) {}

Trainer::~Trainer() = default;

double Trainer::update(const RolloutBatch& batch) {
  plan_->upload(batch);
  return plan_->step();
}

int Trainer::updates() const { return plan_->updates; }

void Trainer::save(const std::filesystem::path& path, const nlohmann::json& metadata,
                   bool overwrite) const {
  const auto& model = plan_->model;
  const auto values = plan_->runtime.download(model.weights().values);
  write_safetensors(path,
                    {{{"format", "touchtrace/model/1"},
                      {"spec", nlohmann::json(model.spec()).dump()},
                      {"metadata", metadata.dump()}},
                     tensors_of(model.table(), values)},
                    overwrite);
}

void Trainer::save_checkpoint(const std::filesystem::path& path) const {
  const auto& model = plan_->model;
  const auto read = [&](const Buffer<float>& buffer) { return plan_->runtime.download(buffer); };
  auto tensors = tensors_of(model.table(), read(model.weights().values));
  for (const auto& [name, moment] : {std::pair{first_moment_name, plan_->adam.first_moment()},
                                     std::pair{second_moment_name, plan_->adam.second_moment()}})
    tensors.push_back({name, {moment.size()}, read(moment)});
  write_safetensors(path,
                    {{{"format", checkpoint_format},
                      {"spec", nlohmann::json(model.spec()).dump()},
                      {"updates", std::to_string(plan_->updates)}},
                     std::move(tensors)},
                    true);
}

void Trainer::load_checkpoint(const std::filesystem::path& path) {
  const auto file = read_safetensors(path);
  const auto& model = plan_->model;
  const int updates = updates_of(file);
  if (updates < 0)
    throw data_error(path.string() + " is not a checkpoint",
                     "name one that touchtrace train wrote");
  const auto values = values_of(model.table(), file);
  const auto write = [&](const char* name, const Buffer<float>& moment) {
    plan_->runtime.write<float>(moment, file.at(name, moment.size()).values);
  };
  write(first_moment_name, plan_->adam.first_moment());
  write(second_moment_name, plan_->adam.second_moment());
  plan_->runtime.write<float>(model.weights().values, values);
  plan_->updates = updates;
}

}  // namespace touchtrace
