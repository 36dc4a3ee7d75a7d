#include "pipeline/cli/configuration.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
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

/// Throws for keys outside any table and for tables that no command reads.
void require_known_tables(const std::string& file, const toml::table& document,
                          const std::vector<std::string>& command_names,
                          const std::string& command) {
  for (const auto& [key, node] : document) {
    if (!node.is_table())
      throw usage_error(fmt::format("{}: key '{}' is outside any table", file, key.str()),
                        fmt::format("put it below [{}]", command));
    if (std::ranges::find(command_names, key.str()) == command_names.end())
      throw usage_error(fmt::format("{}: unknown table [{}]{}", file, key.str(),
                                    did_you_mean(key.str(), command_names)),
                        "tables are named after commands: " + comma_separated(command_names));
  }
}

const Option& find_option(const std::string& file, const std::string& command, std::string_view key,
                          const std::vector<Option>& options) {
  std::vector<std::string> keys;
  for (const Option& option : options) {
    if (option.name == "config" || option.name == "help") continue;
    if (option.key() == key) return option;
    if (!option.help.empty()) keys.push_back(option.key());
  }
  throw usage_error(
      fmt::format("{}: unknown key '{}' in [{}]{}", file, key, command, did_you_mean(key, keys)),
      "keys: " + comma_separated(keys));
}

}  // namespace

void apply_configuration(const std::filesystem::path& file,
                         const std::vector<std::string>& command_names, const std::string& command,
                         const std::vector<Option>& options,
                         const std::vector<std::string>& given) {
  const toml::table document = read_toml_file(file);
  require_known_tables(file.string(), document, command_names, command);
  const toml::table* table = document[command].as_table();
  if (!table) return;
  for (const auto& [key, node] : *table) {
    const Option& option = find_option(file.string(), command, key.str(), options);
    if (std::ranges::find(given, option.name) != given.end()) continue;
    if (!std::visit([&, &value = node](auto* target) { return assign(value, *target); },
                    option.target))
      throw usage_error(
          fmt::format("{}: value of '{}' has the wrong type", file.string(), key.str()),
          option.help);
  }
}

}  // namespace touchtrace::cli
