#include "pipeline/sweep/cells.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/base/json_text.h"
#include "engine/base/text.h"
#include "pipeline/sweep/cell_identity.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::json;

constexpr std::size_t max_cells = 100'000;

/// Whether two sets of axis values are equal on the axes that both have.
bool agree(const json& a, const json& b) {
  for (const auto& [name, value] : a.items())
    if (const auto other = b.find(name); other != b.end() && *other != value) return false;
  return true;
}

json without(json axes, const std::vector<std::string>& names) {
  for (const auto& name : names) axes.erase(name);
  return axes;
}

void collect_references(const json& value, std::vector<std::string>& stages) {
  if (is_reference(value)) {
    const auto stage = parse_reference(value).stage;
    if (std::ranges::find(stages, stage) == stages.end()) stages.push_back(stage);
  } else if (value.is_structured()) {
    for (const json& item : value) collect_references(item, stages);
  }
}

/// Stages to which a stage refers.
std::vector<std::string> referenced_stages(const Stage& stage) {
  std::vector<std::string> stages;
  collect_references(stage.options, stages);
  for (const Axis& axis : stage.axes)
    for (const AxisValue& value : axis.values) collect_references(value.options, stages);
  return stages;
}

/// An option with a file in the help reads it; outputs are set by the sweep.
void require_input(const Option& option, const json& value) {
  if (!(option.positional || option.placeholder == "FILE") || !value.is_string()) return;
  std::error_code unreadable;
  if (const auto file = value.get<std::string>(); !std::filesystem::exists(file, unreadable))
    throw usage_error(fmt::format("{}: there is no file or folder '{}'", option.key(), file),
                      "paths are relative to the folder in which the sweep is started");
}

class Expansion {
 public:
  Expansion(const CommandTable& commands, std::filesystem::path root)
      : commands_(commands), root_(std::move(root)) {}

  std::vector<Cell> run(const Study& study) {
    for (const Stage& stage : study.stages) {
      with_context(fmt::format("[{}]", stage.name), [&] { add(stage); });
      known_.push_back(stage.name);
    }
    return std::move(cells_);
  }

 private:
  /// Axis values and options of a cell that is not yet complete.
  struct Draft {
    json axes, options;
  };

  void add(const Stage& stage) {
    const auto options = commands_.options(stage.command);
    const std::size_t first = cells_.size();
    for (const Draft& draft : multiplied(stage, joined(stage)))
      cells_.push_back(make_cell(stage, draft, options));
    for (std::size_t i = first; i < cells_.size(); ++i)
      for (const auto& entry : cells_[i].axes.items()) axis_names_.insert(entry.key());
  }

  const std::string& require_known(const std::string& stage) const {
    if (std::ranges::find(known_, stage) == known_.end())
      throw usage_error(
          fmt::format("'@{}' refers to no stage above this one", stage),
          known_.empty() ? "put the stage that it needs above it" : suggestion(stage, known_));
    return stage;
  }

  /// Whether a stage sets the option to one value in place of an axis, `STAGE.OPTION` or `OPTION`.
  bool has_one_value(const std::string& axis) const {
    const auto dot = axis.rfind('.');
    const std::string key = dot == std::string::npos ? axis : axis.substr(dot + 1);
    std::map<std::string, std::set<json>> values;  // by stage
    for (const Cell& cell : cells_)
      if (cell.options.contains(key)) values[cell.stage].insert(cell.options.at(key));
    return std::ranges::any_of(values, [&](const auto& entry) {
      const bool is_meant = dot == std::string::npos || entry.first == axis.substr(0, dot);
      return is_meant && entry.second.size() == 1;
    });
  }

  void require_few(std::size_t count) const {
    if (cells_.size() + count > max_cells)
      throw usage_error(fmt::format("the study has more than {} cells", max_cells),
                        "divide it into several studies");
  }

  /// Combinations of the referenced stages' axes, without the gathered ones.
  std::vector<json> joined(const Stage& stage) const {
    std::vector<json> combinations{json::object()};
    std::set<std::string> available;
    for (const auto& name : referenced_stages(stage)) {
      require_known(name);
      std::set<json> seen;
      std::vector<json> next;
      for (const json& combination : combinations)
        for (const Cell& cell : cells_) {
          if (cell.stage != name) continue;
          for (const auto& entry : cell.axes.items()) available.insert(entry.key());
          json axes = without(cell.axes, stage.gather);
          if (!agree(combination, axes)) continue;
          axes.update(combination);
          if (seen.insert(axes).second) next.push_back(std::move(axes));
          require_few(next.size());
        }
      combinations = std::move(next);
    }
    for (const auto& name : stage.gather)
      if (!available.contains(name) && !has_one_value(name))
        throw usage_error(fmt::format("gather: unknown axis '{}'", name),
                          suggestion(name, {available.begin(), available.end()}));
    return combinations;
  }

  /// Adds the stage's own axes.
  std::vector<Draft> multiplied(const Stage& stage, const std::vector<json>& combinations) const {
    std::vector<Draft> drafts;
    for (const json& axes : combinations) drafts.push_back({axes, stage.options});
    for (const Axis& axis : stage.axes) {
      const auto name = axis_names_.contains(axis.name) ? stage.name + "." + axis.name : axis.name;
      require_few(drafts.size() * axis.values.size());
      std::vector<Draft> next;
      for (const Draft& draft : drafts)
        for (const AxisValue& value : axis.values) {
          next.push_back(draft);
          next.back().axes[name] = value.label;
          next.back().options.update(value.options);
        }
      drafts = std::move(next);
    }
    return drafts;
  }

  /// Replaces references by paths in `options` and by ids in `identity`.
  void resolve(Cell& cell, json& identity, const std::vector<Option>& known) const {
    for (auto& [key, value] : cell.options.items()) {
      const Option* option = find_option(known, key);
      json paths = json::array(), ids = json::array();
      for (const json& item : value.is_array() ? value : json::array({value}))
        resolve_item(cell, *option, item, paths, ids);
      const bool is_single = !value.is_array() && !(option->is_list() && is_reference(value));
      value = is_single ? paths[0] : paths;
      identity[key] = is_single ? ids[0] : ids;
    }
  }

  void resolve_item(Cell& cell, const Option& option, const json& item, json& paths,
                    json& ids) const {
    if (!is_reference(item)) {
      require_input(option, item);
      paths.push_back(item);
      ids.push_back(option.choices.empty() ? outside_identity(item) : item);
      return;
    }
    const auto [stage, key] = parse_reference(item);
    auto matches = matching(cell.axes, stage);
    if (!key.empty()) keep_different_values(matches, key);
    if (matches.size() != 1 && (!key.empty() || !option.is_list()))
      throw usage_error(
          fmt::format("{}: '{}' stands for {} {}, not one", option.key(), item.get<std::string>(),
                      matches.size(), key.empty() ? "cells" : "values"),
          "refer to a stage with fewer axes, or gather less");
    for (const std::size_t i : matches) {
      if (key.empty()) {
        paths.push_back(cells_[i].output.string()), ids.push_back("@" + cells_[i].id);
        cell.inputs.push_back(i);
        continue;
      }
      const json& value = value_of(cells_[i], key);
      for (const json& one : value.is_array() ? value : json::array({value}))
        paths.push_back(one), ids.push_back(one);
    }
  }

  std::vector<std::size_t> matching(const json& axes, const std::string& stage) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (cells_[i].stage == stage && agree(axes, cells_[i].axes)) found.push_back(i);
    return found;
  }

  /// Keeps one cell for each value of an option.
  void keep_different_values(std::vector<std::size_t>& cells, const std::string& key) const {
    std::set<json> seen;
    std::erase_if(cells,
                  [&](std::size_t i) { return !seen.insert(value_of(cells_[i], key)).second; });
  }

  static const json& value_of(const Cell& cell, const std::string& key) {
    if (const auto value = cell.options.find(key); value != cell.options.end()) return *value;
    throw usage_error(fmt::format("'@{}.{}' refers to a value that is not given", cell.stage, key),
                      fmt::format("add {} to [{}]", key, cell.stage));
  }

  Cell make_cell(const Stage& stage, const Draft& draft, const std::vector<Option>& options) const {
    Cell cell{stage.name, stage.command,     "", draft.axes, draft.options,
              {},         commands_.version, {}, {},         {}};
    json identity = json::object();
    resolve(cell, identity, options);
    if (!stage.output.empty()) identity["output"] = stage.output;
    cell.id = cell_id(stage.command, identity, options, commands_);
    cell.folder = root_ / "cells" / cell.id;
    cell.output = stage.output.empty() ? cell.result() : cell.folder / stage.output;
    json given = cell.options;
    if (!stage.output.empty()) given["output"] = cell.output.string();
    for (const char* flag : {"json", "overwrite"})
      if (find_option(options, flag)) given[flag] = true;
    cell.arguments = arguments_of(options, given);
    cell.can_resume = find_option(options, "resume") != nullptr;
    return cell;
  }

  const CommandTable& commands_;
  std::filesystem::path root_;
  std::vector<Cell> cells_;
  std::vector<std::string> known_;
  std::set<std::string> axis_names_;
};

}  // namespace

std::string Cell::name() const {
  std::string text = stage;
  for (const auto& [axis, value] : axes.items())
    text += fmt::format(" {}={}", axis, json_text(value));
  return text;
}

std::vector<Cell> expand(const Study& study, const CommandTable& commands,
                         const std::filesystem::path& root) {
  return Expansion(commands, root).run(study);
}

}  // namespace touchtrace::sweep
