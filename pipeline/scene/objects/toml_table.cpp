#include "pipeline/scene/objects/toml_table.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace::scene {

TomlTable::TomlTable(const toml::table& table, std::string where)
    : table_(table), where_(std::move(where)) {}

void TomlTable::reject(const std::string& key, const std::string& fault) const {
  throw data_error(fmt::format("{}: {} {}", where_, key, fault),
                   "correct the file; pipeline/scene/objects holds examples");
}

bool TomlTable::has(const std::string& key) {
  known_.push_back(key);
  return table_.contains(key);
}

const toml::node& TomlTable::get(const std::string& key) {
  if (!has(key)) reject(key, "is missing");
  return *table_.get(key);
}

double TomlTable::number_of(const std::string& key, const toml::node& node, double low,
                            double high) const {
  if (!node.is_number()) reject(key, "is not a number");
  const double value = node.value<double>().value();
  if (!(value >= low && value <= high))
    reject(key, fmt::format("is {:g}, not within {:g} to {:g}", value, low, high));
  return value;
}

double TomlTable::number(const std::string& key, double low, double high) {
  return number_of(key, get(key), low, high);
}

double TomlTable::number_or(const std::string& key, double low, double high, double otherwise) {
  return has(key) ? number(key, low, high) : otherwise;
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t count, double low,
                                       double high) {
  const toml::array* array = get(key).as_array();
  if (!array || array->size() != count) reject(key, fmt::format("does not hold {} numbers", count));
  std::vector<double> values;
  for (const toml::node& node : *array) values.push_back(number_of(key, node, low, high));
  return values;
}

Eigen::Vector3d TomlTable::vector(const std::string& key, double low, double high) {
  const std::vector<double> values = numbers(key, 3, low, high);
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d TomlTable::vector_or(const std::string& key, double low, double high,
                                     const Eigen::Vector3d& otherwise) {
  return has(key) ? vector(key, low, high) : otherwise;
}

std::string TomlTable::text(const std::string& key, std::size_t longest) {
  const auto value = get(key).value_exact<std::string>();
  if (!value || value->size() > longest ||
      std::ranges::any_of(*value, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    reject(key, fmt::format("is no text of one line and {} bytes at the most", longest));
  return *value;
}

std::size_t TomlTable::choice(const std::string& key, const std::vector<std::string>& names) {
  const auto place = std::ranges::find(names, text(key, 64));
  if (place == names.end()) reject(key, "is none of " + comma_separated(names));
  return static_cast<std::size_t>(place - names.begin());
}

void TomlTable::each(const std::string& key, std::size_t most,
                     const std::function<void(TomlTable&)>& read) {
  if (!has(key)) return;
  const toml::array* array = table_.get(key)->as_array();
  if (!array || array->size() > most)
    reject(key, fmt::format("is no list of {} tables at the most", most));
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::table* entry = array->get(i)->as_table();
    if (!entry) reject(key, "holds something else than tables");
    TomlTable inner(*entry, fmt::format("{}: {} {}", where_, key, i + 1));
    read(inner);
    inner.finish();
  }
}

void TomlTable::table(const std::string& key, const std::function<void(TomlTable&)>& read) {
  if (!has(key)) return;
  const toml::table* inner_table = table_.get(key)->as_table();
  if (!inner_table) reject(key, "is no table");
  TomlTable inner(*inner_table, fmt::format("{}: {}", where_, key));
  read(inner);
  inner.finish();
}

void TomlTable::finish() const {
  for (const auto& [key, node] : table_)
    if (std::ranges::find(known_, key.str()) == known_.end())
      throw data_error(fmt::format("{} has no key '{}'", where_, key.str()),
                       suggestion(key.str(), known_));
}

void read_toml(const std::string& text, const std::string& where,
               const std::function<void(TomlTable&)>& read) {
  toml::table document;
  try {
    document = toml::parse(text, where);
  } catch (const toml::parse_error& error) {
    throw data_error(
        fmt::format("{}:{}: {}", where, error.source().begin.line, error.description()),
        "correct the file; it is TOML 1.0");
  }
  TomlTable root(document, where);
  read(root);
  root.finish();
}

}  // namespace touchtrace::scene
