#include <fmt/core.h>

#include "pipeline/cli/commands.h"
#include "pipeline/scene/base/parameter_registry.h"

namespace touchtrace::cli {
namespace {

using scene::Parameter;

struct ParametersOptions {
  std::vector<std::string> settings;
  bool markdown = false;
};

void describe(OptionSet& set, ParametersOptions& o) {
  set.texts("set", o.settings, "print these values instead of the defaults").value("NAME=VALUE");
  set.flag("markdown", o.markdown, "print the tables of pipeline/scene/PARAMETERS.md");
}

nlohmann::json to_json(const Parameter& row, const scene::SceneParameters& parameters) {
  return {{"name", row.name},        {"group", row.group},
          {"unit", row.unit},        {"value", row.values(parameters)},
          {"default", row.values()}, {"min", row.min},
          {"max", row.max},          {"description", row.description},
          {"source", row.source},    {"reason", row.reason}};
}

void print_markdown() {
  std::string group;
  for (const Parameter& row : scene::parameter_registry())
    if (row.group != group) {
      group = row.group;
      fmt::print("{}\n", scene::markdown_table(group));
    }
}

void print_rows(const scene::SceneParameters& parameters) {
  fmt::print("{:<28} {:>18} {:<10} {}\n", "parameter", "value", "unit", "description (source)");
  for (const Parameter& row : scene::parameter_registry())
    fmt::print("{:<28} {:>18} {:<10} {} ({})\n", row.name, value_text(row, parameters), row.unit,
               row.description, row.source.empty() ? "assumed: " + row.reason : row.source);
}

ExitCode run(const ParametersOptions& options, const Invocation& invocation) {
  const scene::SceneParameters parameters = scene::parse_parameters(options.settings);
  if (invocation.json) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Parameter& row : scene::parameter_registry())
      rows.push_back(to_json(row, parameters));
    fmt::print("{}\n", nlohmann::json{{"parameters", rows}}.dump(2));
  } else if (options.markdown) {
    print_markdown();
  } else {
    print_rows(parameters);
  }
  return ExitCode::done;
}

}  // namespace

Command parameters_command() {
  return make_command<ParametersOptions>(
      "parameters", "list the parameters of the simulated scenes with their sources",
      {"touchtrace parameters", "touchtrace parameters --set glove-cross-talk=0.024 --json"}, run);
}

}  // namespace touchtrace::cli
