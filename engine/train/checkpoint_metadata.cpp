#include "engine/train/checkpoint_metadata.h"

#include "engine/base/error.h"
#include "engine/train/tuning_json.h"

namespace touchtrace {
namespace {

constexpr const char* checkpoint_format = "touchtrace/checkpoint/3";

}  // namespace

std::map<std::string, std::string> to_metadata(const ModelSpec& spec,
                                               const CheckpointMetadata& checkpoint) {
  const auto& counts = checkpoint.counts;
  const nlohmann::json training{{"tried", counts.tried},
                                {"left_out", counts.left_out},
                                {"left_out_in_a_row", counts.left_out_in_a_row},
                                {"tuning", checkpoint.tuning},
                                {"notes", checkpoint.notes}};
  return {{"format", checkpoint_format},
          {"spec", nlohmann::json(spec).dump()},
          {"training", training.dump()}};
}

CheckpointMetadata checkpoint_metadata(const TensorFile& file,
                                       const std::filesystem::path& path) try {
  if (file.metadata.at("format") != checkpoint_format) throw std::out_of_range("format");
  const auto training = nlohmann::json::parse(file.metadata.at("training"));
  return {{training.at("tried"), training.at("left_out"), training.at("left_out_in_a_row")},
          training.at("tuning").get<Tuning>(),
          training.at("notes")};
} catch (const std::exception&) {
  throw data_error(path.string() + " is not a whole checkpoint",
                   "name one that touchtrace train wrote, or start anew with --overwrite");
}

}  // namespace touchtrace
