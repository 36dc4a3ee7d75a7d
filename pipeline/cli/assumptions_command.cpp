#include <fmt/core.h>

#include "pipeline/cli/commands.h"
#include "pipeline/scene/base/parameter_registry.h"

namespace touchtrace::cli {
namespace {

using scene::Parameter;

struct AssumptionsOptions {
  std::vector<std::string> assume;
  bool markdown = false;
};

void describe(OptionSet& set, AssumptionsOptions& o) {
  set.texts("assume", o.assume, "NAME=VALUE: shown instead of the default, and checked");
  set.flag("markdown", o.markdown, "the tables of pipeline/scene/PARAMETERS.md");
}

nlohmann::json to_json(const Parameter& row, const scene::SceneParameters& parameters) {
  return {{"name", row.name},           {"part", row.part},
          {"unit", row.unit},           {"value", row.of(parameters)},
          {"default", row.of({})},      {"least", row.least},
          {"most", row.most},           {"meaning", row.meaning},
          {"published", row.published}, {"reason", row.reason}};
}

void print_tables() {
  std::string part;
  for (const Parameter& row : scene::parameter_registry())
    if (row.part != part) {
      part = row.part;
      fmt::print("{}\n", scene::markdown_table(part));
    }
}

void print_rows(const scene::SceneParameters& parameters) {
  fmt::print("{:<22} {:>18} {:<10} {}\n", "assumption", "value", "unit", "meaning (published?)");
  for (const Parameter& row : scene::parameter_registry())
    fmt::print("{:<22} {:>18} {:<10} {} ({})\n", row.name, value_text(row, parameters), row.unit,
               row.meaning, row.published);
}

ExitCode run(const AssumptionsOptions& options, const Invocation& invocation) {
  const scene::SceneParameters parameters = scene::parse_parameters(options.assume);
  if (invocation.json) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Parameter& row : scene::parameter_registry()) rows.push_back(to_json(row, parameters));
    fmt::print("{}\n", nlohmann::json{{"assumptions", rows}}.dump(2));
  } else if (options.markdown) {
    print_tables();
  } else {
    print_rows(parameters);
  }
  return ExitCode::done;
}

}  // namespace

Command parameters_command() {
  return make_command<AssumptionsOptions>(
      "assumptions", "list the numbers that the scenes assume, and where they come from",
      {"touchtrace assumptions", "touchtrace assumptions --assume glove-cross-talk=0.024 --json"},
      run);
}

}  // namespace touchtrace::cli
