#include "pipeline/cli/configuration.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/fault_list.h"
#include "engine/base/text.h"
#include "engine/base/toml_file.h"

namespace touchtrace::cli {
namespace {

template <class T>
bool assign(const toml::node& node, T& target) {
  if constexpr (std::is_same_v<T, std::uint64_t> || std::is_same_v<T, int>) {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < 0 ||
        (std::is_same_v<T, int> && *value > std::numeric_limits<int>::max()))
      return false;
    target = static_cast<T>(*value);
    return true;
  } else if constexpr (std::is_same_v<T, double>) {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    return value && (target = *value, true);
  } else {
    const auto value = node.value_exact<T>();
    return value && (target = *value, true);
  }
}

template <class T>
bool assign(const toml::node& node, std::vector<T>& target) {
  const auto* array = node.as_array();
  if (!array) return false;
  std::vector<T> values(array->size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!assign(*array->get(i), values[i])) return false;
  target = std::move(values);
  return true;
}

/// Finds keys outside any table and tables that no command reads.
void check_tables(const toml::table& document, const std::vector<std::string>& command_names,
                  const std::string& command, FaultList& faults) {
  for (const auto& [key, node] : document) {
    if (!node.is_table())
      faults.add(fmt::format("key '{}' is outside any table", key.str()),
                 fmt::format("put it below [{}]", command));
    else if (std::ranges::find(command_names, key.str()) == command_names.end())
      faults.add(
          fmt::format("unknown table [{}]{}", key.str(), did_you_mean(key.str(), command_names)),
          "tables are named after commands: " + comma_separated(command_names));
  }
}

/// Option of a key of the command's table; null, and a fault, if there is none.
const Option* find_option(const std::string& command, std::string_view key,
                          const std::vector<Option>& options, FaultList& faults) {
  std::vector<std::string> keys;
  for (const Option& option : options) {
    if (option.name == "config" || option.name == "help") continue;
    if (option.key() == key) return &option;
    keys.push_back(option.key());
  }
  faults.add(fmt::format("unknown key '{}' in [{}]{}", key, command, did_you_mean(key, keys)),
             "keys: " + comma_separated(keys));
  return nullptr;
}

/// Assigns the values of the command's table, except of options that are `given`.
void apply_table(const toml::table& table, const std::string& command,
                 const std::vector<Option>& options, const std::vector<std::string>& given,
                 FaultList& faults) {
  for (const auto& [key, node] : table) {
    const Option* option = find_option(command, key.str(), options, faults);
    if (!option || std::ranges::find(given, option->name) != given.end()) continue;
    if (!std::visit([&, &value = node](auto* target) { return assign(value, *target); },
                    option->target))
      faults.add(fmt::format("value of '{}' in [{}] has the wrong type", key.str(), command),
                 option->help);
  }
}

}  // namespace

void apply_configuration(const std::filesystem::path& file,
                         const std::vector<std::string>& command_names, const std::string& command,
                         const std::vector<Option>& options,
                         const std::vector<std::string>& given) {
  const toml::table document = read_toml_file(file);
  FaultList faults;
  check_tables(document, command_names, command, faults);
  if (const toml::table* table = document[command].as_table())
    apply_table(*table, command, options, given, faults);
  faults.throw_if_any(file.string(),
                      fmt::format("`touchtrace {} --help` lists the keys as options", command));
}

}  // namespace touchtrace::cli
