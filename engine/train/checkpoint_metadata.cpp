#include "engine/train/checkpoint_metadata.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/json_number.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr const char* checkpoint_format = "touchtrace/checkpoint/4";
constexpr const char* checkpoint_hint =
    "name one that touchtrace train wrote, or start from scratch with --overwrite";

int count_in(const json& training, const char* key) {
  return static_cast<int>(whole_number(training.at(key), key, 0, INT32_MAX));
}

}  // namespace

std::map<std::string, std::string> to_metadata(const CheckpointMetadata& checkpoint) {
  const auto& counts = checkpoint.counts;
  const json training{{"attempted", counts.attempted},
                      {"skipped", counts.skipped},
                      {"consecutive_skips", counts.consecutive_skips},
                      {"notes", checkpoint.notes}};
  return {{"format", checkpoint_format},
          {"spec", json(checkpoint.spec).dump()},
          {"training", training.dump()}};
}

CheckpointMetadata checkpoint_metadata(const TensorFile& file,
                                       const std::filesystem::path& path) try {
  if (file.metadata.at("format") != checkpoint_format)
    throw data_error(
        fmt::format("format '{}'; expected '{}'", file.metadata.at("format"), checkpoint_format),
        "");
  const auto training = json::parse(file.metadata.at("training"));
  return {json::parse(file.metadata.at("spec")).get<ModelSpec>(),
          {count_in(training, "attempted"), count_in(training, "skipped"),
           count_in(training, "consecutive_skips")},
          training.at("notes")};
} catch (const Error& error) {
  throw data_error(fmt::format("{} is not a valid checkpoint: {}", path.string(), error.what()),
                   checkpoint_hint);
} catch (const std::exception&) {  // a missing key or invalid JSON
  throw data_error(path.string() + " is not a valid checkpoint", checkpoint_hint);
}

void check_resumable(const CheckpointMetadata& checkpoint, const ModelSpec& spec,
                     const std::filesystem::path& path) {
  const json stored = checkpoint.spec, wanted = spec;
  for (const auto& side : {stored, wanted})
    for (const auto& [key, ignored] : side.items()) {
      const auto in = [&key = key](const json& spec_json) {
        return spec_json.contains(key) ? spec_json.at(key).dump() : "absent";
      };
      if (in(stored) != in(wanted))
        throw data_error(fmt::format("{} was written for another model: '{}' is {}, here {}",
                                     path.string(), key, in(stored), in(wanted)),
                         "resume with the options that it was started with");
    }
}

}  // namespace touchtrace
