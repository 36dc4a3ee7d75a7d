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

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& output)
    : weights_(output.string() + ".checkpoint"), best_(output.string() + ".checkpoint.best") {}

bool Checkpoint::exists() const { return std::filesystem::exists(weights_); }

void Checkpoint::save(const Trainer& trainer, const TrainingPosition& position,
                      const nlohmann::json& identity) const {
  trainer.save_checkpoint(weights_, to_json(position, identity));
}

TrainingPosition Checkpoint::load(Trainer& trainer, const nlohmann::json& identity) const {
  if (!exists())
    throw data_error(fmt::format("no checkpoint {}", weights_.string()), "run without --resume");
  const auto notes = Trainer::checkpoint_notes(weights_);
  try {
    if (notes.at("identity") != identity)
      throw data_error(
          fmt::format("{} belongs to a run with other options or data", weights_.string()),
          "use the options of that run, or start again with --overwrite");
    TrainingPosition position{notes.at("log"), notes.at("seconds"), notes.at("loss_sum"),
                              notes.at("loss_count")};
    trainer.load_checkpoint(weights_);
    return position;
  } catch (const nlohmann::json::exception&) {
    throw data_error(fmt::format("{} is damaged", weights_.string()),
                     "start again with --overwrite");
  }
}

void Checkpoint::remove() const noexcept {
  std::error_code ignored;
  for (const auto& path : {weights_, best_}) std::filesystem::remove(path, ignored);
}

}  // namespace touchtrace::study
