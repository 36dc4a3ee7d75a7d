#include "pipeline/sweep/study.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "engine/base/text.h"
#include "pipeline/sweep/command_chain.h"
#include "pipeline/sweep/study_file.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::json;

/// Keys of a stage that are not options of its command.
const std::set<std::string> own_keys{"command", "gather", "output"};
/// Options that the sweep sets itself.
const std::set<std::string> reserved{"output", "json",   "overwrite", "quiet",
                                     "config", "resume", "help"};

const Option& require_option(const std::vector<Option>& options, const std::string& key) {
  const Option* option = find_option(options, key);
  if (option && !reserved.contains(key)) return *option;
  if (option)
    throw usage_error(fmt::format("'{}' is set by the sweep", key), "remove it from the study");
  std::vector<std::string> keys;
  for (const Option& known : options)
    if (!reserved.contains(known.key())) keys.push_back(known.key());
  throw usage_error(fmt::format("unknown key '{}'{}", key, did_you_mean(key, keys)),
                    "keys: " + comma_separated(keys));
}

Axis values_axis(const std::string& key, const json& values) {
  Axis axis{key, {}};
  for (const json& value : values) axis.values.push_back({value, {{key, value}}});
  return axis;
}

Axis cases_axis(const std::string& name, const json& cases, const std::vector<Option>& options) {
  Axis axis{name, {}};
  for (const auto& [label, given] : cases.items()) {
    if (!given.is_object())
      throw usage_error(fmt::format("'{}.{}' is not a table", name, label),
                        "give the options of this case, e.g. { seed = 2 }");
    for (const auto& entry : given.items()) require_option(options, entry.key());
    axis.values.push_back({label, given});
  }
  return axis;
}

std::string output_of(const json& table, const std::string& command,
                      const std::vector<Option>& options) {
  if (!find_option(options, "output")) return "";
  const json name = table.value("output", json(default_output(command)));
  if (!name.is_string() || name.get<std::string>().empty() ||
      name.get<std::string>().find('/') != std::string::npos || name.get<std::string>()[0] == '.')
    throw usage_error(fmt::format("output cannot be {}", name.dump()),
                      "give the name of a file in the folder of the cell, e.g. \"labels.h5\"");
  return name;
}

std::vector<std::string> gather_of(const json& table) {
  const json names = table.value("gather", json::array());
  if (names.is_array() && std::ranges::all_of(names, [](const json& n) { return n.is_string(); }))
    return names;
  throw usage_error(fmt::format("gather cannot be {}", names.dump()),
                    "give a list of axes, e.g. [\"variant\"]");
}

void add_entry(Stage& stage, const std::string& key, const json& value,
               const std::vector<Option>& options) {
  if (value.is_object()) {
    stage.axes.push_back(cases_axis(key, value, options));
  } else if (const Option& option = require_option(options, key);
             value.is_array() && !option.is_list()) {
    stage.axes.push_back(values_axis(key, value));
  } else {
    stage.options[key] = value;
    return;
  }
  const auto& values = stage.axes.back().values;
  if (values.empty())
    throw usage_error(fmt::format("axis '{}' has no values", key), "give at least one value");
  std::set<json> labels;
  for (const auto& value : values)
    if (!labels.insert(value.label).second)
      throw usage_error(fmt::format("axis '{}' has {} twice", key, value.label.dump()),
                        "give each value once: equal cells are one run");
}

Stage stage_of(const std::string& name, const json& table, const CommandTable& commands) {
  const json command = table.value("command", json(name));
  if (!command.is_string() || command == "sweep")
    throw usage_error(fmt::format("command cannot be {}", command.dump()),
                      "name a command of `touchtrace --list`");
  const auto options = commands.options(command);
  Stage stage{name, command, output_of(table, command, options), json::object(), {}, {}};
  stage.gather = gather_of(table);
  for (const auto& [key, value] : table.items())
    if (!own_keys.contains(key)) add_entry(stage, key, value, options);
  return stage;
}

}  // namespace

bool is_reference(const json& value) {
  return value.is_string() && value.get_ref<const std::string&>().starts_with('@');
}

Reference parse_reference(const json& value) {
  const std::string text = value.get<std::string>().substr(1);
  const auto dot = text.find('.');
  return {text.substr(0, dot), dot == std::string::npos ? "" : text.substr(dot + 1)};
}

Study read_study(const std::string& source, const std::vector<std::string>& changes,
                 const CommandTable& commands) {
  Study study;
  const auto chain = parse_command_chain(source);
  auto tables = chain ? *chain : read_stage_tables(source);
  std::set<std::string> changed;
  for (const auto& given : changes) {
    const auto change = chain ? name_stage(given, tables, commands) : given;
    const auto option = change.substr(0, change.find('='));
    if (!changed.insert(option).second)
      throw usage_error(fmt::format("'{}' is set twice", option),
                        "give all values at once, separated by commas");
    apply_change(tables, change);
  }
  if (chain) link_stages(tables);
  for (const auto& [name, table] : tables)
    study.stages.push_back(with_context(fmt::format("{}: [{}]", source, name),
                                        [&] { return stage_of(name, table, commands); }));
  return study;
}

}  // namespace touchtrace::sweep
