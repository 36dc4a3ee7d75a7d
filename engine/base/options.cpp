#include "engine/base/options.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void validate_number(const Option& option, double value) {
  if (!(value >= option.minimum && value <= option.maximum))
    throw usage_error(fmt::format("--{} {} is out of range", option.name, value),
                      fmt::format("pass a value from {} to {}", option.minimum, option.maximum));
}

void validate_text(const Option& option, const std::string& value) {
  if (option.required && value.empty())
    throw usage_error(fmt::format("--{} is missing", option.name), option.help);
  if (!option.choices.empty() && std::ranges::find(option.choices, value) == option.choices.end())
    throw usage_error(fmt::format("invalid --{} '{}'", option.name, value),
                      suggestion(value, option.choices));
}

}  // namespace

void OptionSet::flag(std::string name, bool& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 1, {}});
}

void OptionSet::integer(std::string name, int& target, std::string help, int minimum, int maximum) {
  options_.push_back(
      {std::move(name), &target, std::move(help), double(minimum), double(maximum), {}});
}

void OptionSet::seed(std::string name, std::uint64_t& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, infinity, {}});
}

void OptionSet::number(std::string name, double& target, std::string help, double minimum,
                       double maximum) {
  options_.push_back({std::move(name), &target, std::move(help), minimum, maximum, {}});
}

void OptionSet::numbers(std::string name, std::vector<double>& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), -infinity, infinity, {}});
}

void OptionSet::text(std::string name, std::string& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}});
}

void OptionSet::texts(std::string name, std::vector<std::string>& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}});
}

void OptionSet::choice(std::string name, std::string& target, std::string help,
                       std::vector<std::string> choices) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, std::move(choices)});
}

void OptionSet::path(std::string name, std::string& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}, true});
}

void OptionSet::paths(std::string name, std::vector<std::string>& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}, true});
}

void OptionSet::input(std::string name, std::string& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}, true, true});
}

void OptionSet::optional_input(std::string name, std::string& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}, false, true});
}

void OptionSet::inputs(std::string name, std::vector<std::string>& target, std::string help) {
  options_.push_back({std::move(name), &target, std::move(help), 0, 0, {}, true, true});
}

std::vector<std::string> OptionSet::names() const {
  std::vector<std::string> names;
  for (const auto& option : options_) names.push_back(option.name);
  return names;
}

nlohmann::json OptionSet::values() const {
  nlohmann::json values = nlohmann::json::object();
  for (const auto& option : options_) {
    std::string key = option.name;
    std::ranges::replace(key, '-', '_');
    std::visit([&](auto* target) { values[key] = *target; }, option.target);
  }
  return values;
}

void OptionSet::validate() const {
  for (const auto& option : options_)
    std::visit(
        [&](auto* target) {
          using Value = std::remove_pointer_t<decltype(target)>;
          if constexpr (std::is_arithmetic_v<Value>)
            validate_number(option, static_cast<double>(*target));
          else if constexpr (std::is_same_v<Value, std::string>)
            validate_text(option, *target);
          else if constexpr (std::is_same_v<Value, std::vector<double>>)
            for (double value : *target) validate_number(option, value);
          else if (option.required && target->empty())
            throw usage_error(fmt::format("{} is missing", option.name), option.help);
        },
        option.target);
}

}  // namespace touchtrace
