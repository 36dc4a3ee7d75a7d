#include "engine/base/options.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/base/fault_list.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string upper_case(std::string text) {
  for (char& c : text)
    c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string text_of(const Option::Target& target) {
  return std::visit(
      [](const auto* value) -> std::string {
        using Value = std::remove_cvref_t<decltype(*value)>;
        if constexpr (std::is_same_v<Value, bool>)
          return "";
        else if constexpr (std::is_same_v<Value, std::vector<std::string>> ||
                           std::is_same_v<Value, std::vector<double>>)
          return fmt::format("{}", fmt::join(*value, " "));
        else
          return fmt::format("{}", *value);
      },
      target);
}

void validate_number(const Option& option, double value, FaultList& faults) {
  if (value >= option.minimum && value <= option.maximum) return;
  const auto range = option.maximum < infinity
                         ? fmt::format("from {} to {}", option.minimum, option.maximum)
                         : fmt::format("at least {}", option.minimum);
  faults.add(fmt::format("{} must be {}, not {}", option.label(), range, value), option.help);
}

void validate_numbers(const Option& option, const std::vector<double>& values, FaultList& faults) {
  if (!values.empty() && values.size() != option.count)
    faults.add(fmt::format("{} needs {} numbers, {}, not {}", option.label(), option.count,
                           option.placeholder, values.size()),
               option.help);
  for (double value : values) validate_number(option, value, faults);
}

void validate_text(const Option& option, const std::string& value, FaultList& faults) {
  if (option.choices.empty() || std::ranges::find(option.choices, value) != option.choices.end())
    return;
  faults.add(fmt::format("{} cannot be '{}'{}", option.label(), value,
                         did_you_mean(value, option.choices)),
             "choices: " + comma_separated(option.choices));
}

}  // namespace

bool Option::is_empty() const {
  return std::visit(
      [](const auto* value) {
        if constexpr (requires { value->empty(); })
          return value->empty();
        else
          return false;
      },
      target);
}

std::string Option::label() const { return positional ? placeholder : "--" + name; }

std::string Option::key() const {
  std::string key = name;
  std::ranges::replace(key, '-', '_');
  return key;
}

Option& Option::value(std::string text) {
  placeholder = std::move(text);
  return *this;
}

Option& OptionSet::add(Option option) {
  option.group = group_;
  option.default_text = text_of(option.target);
  options_.push_back(std::move(option));
  return options_.back();
}

Option& OptionSet::flag(std::string name, bool& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, 1, {}});
}

Option& OptionSet::integer(std::string name, int& target, std::string help, int minimum,
                           int maximum) {
  return add({std::move(name), &target, std::move(help), double(minimum), double(maximum), {}})
      .value("N");
}

Option& OptionSet::seed(std::string name, std::uint64_t& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, infinity, {}}).value("N");
}

Option& OptionSet::number(std::string name, double& target, std::string help, double minimum,
                          double maximum) {
  return add({std::move(name), &target, std::move(help), minimum, maximum, {}}).value("X");
}

Option& OptionSet::numbers(std::string name, std::vector<double>& target, std::string help,
                           std::size_t count, double minimum, double maximum) {
  Option& option = add({std::move(name), &target, std::move(help), minimum, maximum, {}});
  option.count = count;
  return option.value("X...");
}

Option& OptionSet::text(std::string name, std::string& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, 0, {}}).value("TEXT");
}

Option& OptionSet::texts(std::string name, std::vector<std::string>& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, 0, {}}).value("TEXT");
}

Option& OptionSet::choice(std::string name, std::string& target, std::string help,
                          std::vector<std::string> choices) {
  std::string list;
  for (const auto& choice : choices) list += (list.empty() ? "{" : ",") + choice;
  return add({std::move(name), &target, std::move(help), 0, 0, std::move(choices)})
      .value(list + "}");
}

Option& OptionSet::path(std::string name, std::string& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, 0, {}, true}).value("PATH");
}

Option& OptionSet::paths(std::string name, std::vector<std::string>& target, std::string help) {
  return add({std::move(name), &target, std::move(help), 0, 0, {}, true}).value("PATH");
}

Option& OptionSet::input(std::string name, std::string& target, std::string help) {
  auto placeholder = upper_case(name);
  return add({std::move(name), &target, std::move(help), 0, 0, {}, true, true})
      .value(std::move(placeholder));
}

Option& OptionSet::inputs(std::string name, std::vector<std::string>& target, std::string help) {
  auto placeholder = upper_case(name);
  return add({std::move(name), &target, std::move(help), 0, 0, {}, true, true})
      .value(std::move(placeholder));
}

Option& OptionSet::optional_input(std::string name, std::string& target, std::string help) {
  auto placeholder = upper_case(name);
  return add({std::move(name), &target, std::move(help), 0, 0, {}, false, true})
      .value(std::move(placeholder));
}

std::vector<std::string> OptionSet::names() const {
  std::vector<std::string> names;
  for (const auto& option : options_) names.push_back(option.name);
  return names;
}

nlohmann::json OptionSet::values() const {
  nlohmann::json values = nlohmann::json::object();
  for (const auto& option : options_)
    std::visit([&](const auto* target) { values[option.key()] = *target; }, option.target);
  return values;
}

void OptionSet::validate() const {
  FaultList faults;
  for (const auto& option : options_) {
    if (option.required && option.is_empty()) {
      faults.add("missing " + option.label(), option.help);
      continue;
    }
    std::visit(
        [&](const auto* target) {
          using Value = std::remove_cvref_t<decltype(*target)>;
          if constexpr (std::is_arithmetic_v<Value>)
            validate_number(option, static_cast<double>(*target), faults);
          else if constexpr (std::is_same_v<Value, std::vector<double>>)
            validate_numbers(option, *target, faults);
          else if constexpr (std::is_same_v<Value, std::string>)
            validate_text(option, *target, faults);
        },
        option.target);
  }
  faults.throw_if_any("", "correct all of them");
}

}  // namespace touchtrace
