#include "pipeline/cli/configuration.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/text.h"

namespace touchtrace::cli {
namespace {

std::string key_of(std::string name) {
  std::ranges::replace(name, '-', '_');
  return name;
}

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

toml::table parse(const std::filesystem::path& file) {
  try {
    return toml::parse(read_file(file, 1 << 20), file.string());
  } catch (const toml::parse_error& error) {
    throw usage_error(
        fmt::format("{}:{}: {}", file.string(), error.source().begin.line, error.description()),
        "correct the file; it is TOML 1.0");
  }
}

}  // namespace

void apply_configuration(const std::filesystem::path& file, const std::string& command,
                         OptionSet& options, const std::vector<std::string>& given) {
  const toml::table document = parse(file);
  const toml::table* table = document[command].as_table();
  if (!table) return;
  std::vector<std::string> keys;
  for (const auto& option : options.options()) keys.push_back(key_of(option.name));
  for (const auto& [key, node] : *table) {
    const auto place = std::ranges::find(keys, key.str());
    if (place == keys.end())
      throw usage_error(fmt::format("{}: [{}] has no key '{}'", file.string(), command, key.str()),
                        suggestion(key.str(), keys));
    const Option& option = options.options()[static_cast<std::size_t>(place - keys.begin())];
    if (std::ranges::find(given, option.name) != given.end()) continue;
    const bool assigned =
        std::visit([&](auto* target) { return assign(node, *target); }, option.target);
    if (!assigned)
      throw usage_error(
          fmt::format("{}: {} has a value of the wrong type", file.string(), key.str()),
          option.help);
  }
}

}  // namespace touchtrace::cli
