#include "pipeline/sweep/study_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/base/text.h"
#include "engine/base/toml_file.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::json;

constexpr std::int64_t max_range = 100'000;

json json_of(const toml::table& table) {
  std::ostringstream text;
  text << toml::json_formatter(table);
  return json::parse(text.str());
}

/// Numbers, booleans and quoted texts as TOML writes them, separated by commas; null for others.
json toml_values(const std::string& text) {
  try {
    json values = json_of(toml::parse("values = [" + text + "]"))["values"];
    if (std::ranges::all_of(values, [](const json& value) { return value.is_primitive(); }))
      return values;
  } catch (const toml::parse_error&) {
  }
  return nullptr;
}

/// One value; a text where it is not TOML.
json value_of(const std::string& text) {
  const json values = toml_values(text);
  return values.size() == 1 ? values[0] : json(text);
}

json values_of(const std::string& text) {
  if (auto values = toml_values(text); !values.empty()) return values;
  json values = json::array();
  for (const auto& part : split_text(text, ',')) {
    const auto colon = part.find(':');
    std::int64_t first = 0, last = 0;
    if (colon == std::string::npos || !parse_whole(part.substr(0, colon), first) ||
        !parse_whole(part.substr(colon + 1), last)) {
      values.push_back(value_of(part));
      continue;
    }
    if (last < first || last >= max_range || first <= -max_range)
      throw usage_error(fmt::format("'{}' is not a range", part), "give FIRST:LAST, e.g. 1:5");
    for (; first <= last; ++first) values.push_back(first);
  }
  return values;
}

/// Keeps the named cases only.
json selected(const json& cases, const json& names) {
  json kept = json::object();
  std::vector<std::string> known;
  for (const auto& [name, options] : cases.items()) known.push_back(name);
  for (const json& name : names) {
    const auto text = json_text(name);
    if (!cases.contains(text))
      throw usage_error(fmt::format("unknown case '{}'", text), suggestion(text, known));
    kept[text] = cases[text];
  }
  return kept;
}

json& find_table(std::vector<StageTable>& tables, const std::string& name) {
  std::vector<std::string> names;
  for (auto& [known, table] : tables) {
    if (known == name) return table;
    names.push_back(known);
  }
  throw usage_error(fmt::format("unknown stage '{}'", name), suggestion(name, names));
}

}  // namespace

std::vector<StageTable> read_stage_tables(const std::filesystem::path& file) {
  const toml::table document = read_toml_file(file);
  std::vector<std::pair<toml::source_index, StageTable>> found;
  for (const auto& [key, node] : document) {
    if (!node.is_table())
      throw usage_error(fmt::format("{}: key '{}' is outside any table", file.string(), key.str()),
                        "put it below a stage, e.g. [simulate]");
    found.push_back(
        {node.source().begin.line, {std::string(key.str()), json_of(*node.as_table())}});
  }
  if (found.empty())
    throw usage_error(fmt::format("{} has no stages", file.string()),
                      "a stage is a table named after a command, e.g. [simulate]");
  std::ranges::sort(found, {}, [](const auto& entry) { return entry.first; });
  std::vector<StageTable> tables;
  for (auto& [line, table] : found) tables.push_back(std::move(table));
  return tables;
}

void apply_change(std::vector<StageTable>& tables, const std::string& change) {
  const auto equals = change.find('='), dot = change.find('.');
  if (equals == std::string::npos || dot > equals)
    throw usage_error(fmt::format("cannot set '{}'", change),
                      "give STAGE.OPTION=VALUES, e.g. train.seed=1:3");
  json& table = find_table(tables, change.substr(0, dot));
  const std::string key = change.substr(dot + 1, equals - dot - 1);
  const json values = values_of(change.substr(equals + 1));
  if (table.contains(key) && table[key].is_object())
    table[key] = selected(table[key], values);
  else
    table[key] = values.size() == 1 ? values[0] : values;
}

}  // namespace touchtrace::sweep
