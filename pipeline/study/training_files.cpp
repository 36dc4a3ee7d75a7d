#include "pipeline/study/training_files.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace::study {
namespace {

nlohmann::json to_json(const TrainingPosition& position, const nlohmann::json& identity) {
  return {{"identity", identity},
          {"log", position.log},
          {"seconds", position.seconds},
          {"loss_sum", position.loss_sum},
          {"loss_count", position.loss_count}};
}

constexpr const char* best_prefix = "best.";

std::vector<Tensor> with_prefix(std::vector<Tensor> tensors) {
  for (Tensor& tensor : tensors) tensor.name = best_prefix + tensor.name;
  return tensors;
}

/// The tensors that had been given the prefix, without it.
std::vector<Tensor> without_prefix(const std::vector<Tensor>& tensors) {
  std::vector<Tensor> found;
  for (const Tensor& tensor : tensors)
    if (tensor.name.starts_with(best_prefix)) {
      found.push_back(tensor);
      found.back().name.erase(0, std::string_view(best_prefix).size());
    }
  return found;
}

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& output)
    : path_(output.string() + ".checkpoint") {}

bool Checkpoint::exists() const { return std::filesystem::exists(path_); }

void Checkpoint::save(const Trainer& trainer, const TrainingPosition& position,
                      const nlohmann::json& identity) const {
  trainer.save_checkpoint(path_, to_json(position, identity), with_prefix(position.best));
}

TrainingPosition Checkpoint::load(Trainer& trainer, const nlohmann::json& identity) const {
  if (!exists())
    throw data_error(fmt::format("no checkpoint {}", path_.string()), "run without --resume");
  const auto notes = Trainer::checkpoint_notes(path_);
  try {
    if (notes.at("identity") != identity)
      throw data_error(
          fmt::format("{} belongs to a run with other options or data", path_.string()),
          "use the options of that run, or start again with --overwrite");
    TrainingPosition position{notes.at("log"), notes.at("seconds"), notes.at("loss_sum"),
                              notes.at("loss_count"),
                              without_prefix(read_safetensors(path_).tensors)};
    if (position.best.empty() != position.log.empty())
      throw data_error(fmt::format("{} has no weights of its validations", path_.string()),
                       "start again with --overwrite");
    trainer.load_checkpoint(path_);
    return position;
  } catch (const nlohmann::json::exception&) {
    throw data_error(fmt::format("{} is damaged", path_.string()), "start again with --overwrite");
  }
}

void Checkpoint::remove() const noexcept {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace touchtrace::study
