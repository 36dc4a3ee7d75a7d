#include "pipeline/study/training_files.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace::study {
namespace {

constexpr std::uintmax_t max_position_bytes = 64u << 20;

nlohmann::json to_json(const TrainingPosition& position, const nlohmann::json& identity) {
  return {{"identity", identity},
          {"log", position.log},
          {"seconds", position.seconds},
          {"loss_sum", position.loss_sum},
          {"loss_count", position.loss_count}};
}

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& output)
    : weights_(output.string() + ".checkpoint"),
      position_(output.string() + ".checkpoint.json"),
      best_(output.string() + ".checkpoint.best") {}

bool Checkpoint::exists() const { return std::filesystem::exists(weights_); }

void Checkpoint::save(const Trainer& trainer, const TrainingPosition& position,
                      const nlohmann::json& identity) const {
  write_file(position_, to_json(position, identity).dump(1), true);
  trainer.save_checkpoint(weights_);
}

TrainingPosition Checkpoint::load(Trainer& trainer, const nlohmann::json& identity) const {
  if (!exists())
    throw data_error(fmt::format("there is no checkpoint {} to go on from", weights_.string()),
                     "run without --resume");
  try {
    const auto json = nlohmann::json::parse(read_file(position_, max_position_bytes));
    if (json.at("identity") != identity)
      throw data_error(fmt::format("{} is of a run with other options or data", weights_.string()),
                       "give the options of that run, or start anew with --overwrite");
    trainer.load_checkpoint(weights_);
    TrainingPosition position{json.at("log"), json.at("seconds"), json.at("loss_sum"),
                              json.at("loss_count")};
    std::erase_if(position.log,
                  [&](const auto& entry) { return entry.update > trainer.updates(); });
    return position;
  } catch (const nlohmann::json::exception&) {
    throw data_error(fmt::format("{} is damaged", position_.string()),
                     "start anew with --overwrite");
  }
}

void Checkpoint::remove() const noexcept {
  std::error_code ignored;
  for (const auto& path : {weights_, position_, best_}) std::filesystem::remove(path, ignored);
}

}  // namespace touchtrace::study
