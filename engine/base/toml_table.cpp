#include "engine/base/toml_table.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {

TomlTable::TomlTable(const toml::table& table, std::string where, std::string hint)
    : table_(table), where_(std::move(where)), hint_(std::move(hint)) {}

void TomlTable::reject(const std::string& key, const std::string& fault) const {
  throw data_error(fmt::format("{}: {} {}", where_, key, fault), hint_);
}

bool TomlTable::has(const std::string& key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.push_back(key);
  return table_.contains(key);
}

const toml::node& TomlTable::get(const std::string& key) {
  if (!has(key)) reject(key, "is missing");
  return *table_.get(key);
}

double TomlTable::to_number(const std::string& key, const toml::node& node, double min,
                            double max) const {
  if (!node.is_number()) reject(key, "is not a number");
  // value<double>() has none for an integer that no double equals.
  const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                                         : node.as_floating_point()->get();
  if (!(value >= min && value <= max))
    reject(key, fmt::format("is {:g}, not in {:g} to {:g}", value, min, max));
  return value;
}

double TomlTable::number(const std::string& key, double min, double max) {
  return to_number(key, get(key), min, max);
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t count, double min,
                                       double max) {
  const toml::array* array = get(key).as_array();
  if (!array || array->size() != count) reject(key, fmt::format("does not hold {} numbers", count));
  std::vector<double> values;
  for (const toml::node& node : *array) values.push_back(to_number(key, node, min, max));
  return values;
}

int TomlTable::integer(const std::string& key, int min, int max) {
  const double value = number(key, min, max);
  if (value != std::floor(value)) reject(key, fmt::format("is {:g}, not a whole number", value));
  return static_cast<int>(value);
}

std::string TomlTable::text(const std::string& key, std::size_t max_bytes) {
  const auto value = get(key).value_exact<std::string>();
  if (!value || value->size() > max_bytes ||
      std::ranges::any_of(*value, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    reject(key, fmt::format("is not a text of one line of at most {} bytes", max_bytes));
  return *value;
}

std::size_t TomlTable::choice(const std::string& key, const std::vector<std::string>& names) {
  const auto found = std::ranges::find(names, text(key, 64));
  if (found == names.end()) reject(key, "is not one of " + comma_separated(names));
  return static_cast<std::size_t>(found - names.begin());
}

void TomlTable::each(const std::string& key, std::size_t max_tables,
                     const std::function<void(TomlTable&)>& read) {
  if (!has(key)) return;
  const toml::array* array = table_.get(key)->as_array();
  if (!array || array->size() > max_tables)
    reject(key, fmt::format("is not a list of at most {} tables", max_tables));
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::table* entry = array->get(i)->as_table();
    if (!entry) reject(key, "holds a value that is not a table");
    TomlTable inner(*entry, fmt::format("{}: {} {}", where_, key, i + 1), hint_);
    read(inner);
    inner.reject_unknown_keys();
  }
}

void TomlTable::table(const std::string& key, const std::function<void(TomlTable&)>& read) {
  if (!has(key)) return;
  const toml::table* inner_table = table_.get(key)->as_table();
  if (!inner_table) reject(key, "is not a table");
  TomlTable inner(*inner_table, fmt::format("{}: {}", where_, key), hint_);
  read(inner);
  inner.reject_unknown_keys();
}

void TomlTable::reject_unknown_keys() const {
  std::vector<std::string> unknown;
  for (const auto& [key, node] : table_)
    if (std::ranges::find(known_, key.str()) == known_.end()) unknown.emplace_back(key.str());
  if (unknown.empty()) return;
  throw data_error(fmt::format("{}: unknown key{} '{}'", where_, unknown.size() > 1 ? "s" : "",
                               fmt::join(unknown, "', '")),
                   suggestion(unknown.front(), known_));
}

void read_toml(const std::string& text, const std::string& where, const std::string& hint,
               const std::function<void(TomlTable&)>& read) {
  toml::table document;
  try {
    document = toml::parse(text, where);
  } catch (const toml::parse_error& error) {
    throw data_error(
        fmt::format("{}:{}: {}", where, error.source().begin.line, error.description()),
        "write it in TOML 1.0");
  }
  TomlTable root(document, where, hint);
  read(root);
  root.reject_unknown_keys();
}

}  // namespace touchtrace
