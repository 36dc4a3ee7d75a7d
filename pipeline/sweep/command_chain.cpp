#include "pipeline/sweep/command_chain.h"

#include <fmt/core.h>

#include <filesystem>
#include <span>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace::sweep {
namespace {

/// Option of a command that takes what another command writes.
struct Link {
  const char *command, *key, *writer;
};

constexpr Link links[] = {
    {"calibrate", "recording", "simulate"}, {"label", "recording", "simulate"},
    {"label", "calibration", "calibrate"},  {"train", "recording", "simulate"},
    {"train", "labels", "label"},           {"evaluate", "recording", "simulate"},
    {"evaluate", "labels", "label"},        {"evaluate", "model", "train"}};

/// What an earlier stage writes or was given for this option; empty: nothing.
std::string source_of(const Link& link, std::span<const StageTable> earlier) {
  for (const StageTable& stage : earlier)
    if (stage.name == link.writer) return "@" + stage.name;
  for (const StageTable& stage : earlier)
    if (stage.table.contains(link.key)) return fmt::format("@{}.{}", stage.name, link.key);
  return "";
}

/// Names of the options of a stage that have several values.
nlohmann::json axes_of(const StageTable& stage) {
  nlohmann::json names = nlohmann::json::array();
  for (const auto& [key, value] : stage.table.items())
    if (value.is_array()) names.push_back(key);
  return names;
}

}  // namespace

std::optional<std::vector<StageTable>> parse_command_chain(const std::string& study) {
  const bool is_path = study.find_first_of("./") != std::string::npos;
  if (is_path || std::filesystem::exists(study)) return std::nullopt;
  std::vector<StageTable> stages;
  for (const std::string& command : split_text(study, '+'))
    stages.push_back({command, nlohmann::json::object()});
  return stages;
}

std::string name_stage(const std::string& change, const std::vector<StageTable>& stages,
                       const CommandTable& commands) {
  const std::string key = change.substr(0, change.find('='));
  if (key.find('.') != std::string::npos) return change;
  std::vector<std::string> keys;
  for (const StageTable& stage : stages)
    for (const Option& option : commands.options(stage.name)) {
      if (option.key() == key) return fmt::format("{}.{}", stage.name, change);
      keys.push_back(option.key());
    }
  throw usage_error(fmt::format("no stage has the option '{}'", key), suggestion(key, keys));
}

void link_stages(std::vector<StageTable>& stages) {
  for (std::size_t i = 0; i < stages.size(); ++i) {
    auto& [name, table] = stages[i];
    for (const Link& link : links) {
      if (name != link.command || table.contains(link.key)) continue;
      const std::string source = source_of(link, std::span(stages).first(i));
      if (!source.empty()) table[link.key] = source;
    }
    for (std::size_t j = 0; name == "evaluate" && j < i; ++j)
      if (stages[j].name == "train") table["gather"] = axes_of(stages[j]);
  }
}

}  // namespace touchtrace::sweep
