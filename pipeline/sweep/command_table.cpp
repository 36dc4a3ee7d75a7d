#include "pipeline/sweep/command_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"
#include "engine/base/json_text.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::json;

void require_type(const Option& option, const json& value) {
  const bool fits = option.is_flag()   ? value.is_boolean()
                    : option.is_list() ? !value.is_object()
                                       : value.is_string() || value.is_number();
  if (!fits)
    throw usage_error(fmt::format("{} cannot be {}", option.key(), value.dump()), option.help);
}

}  // namespace

const Option* find_option(const std::vector<Option>& options, const std::string& key) {
  const auto option =
      std::ranges::find_if(options, [&](const Option& o) { return o.key() == key; });
  return option == options.end() ? nullptr : &*option;
}

std::vector<std::string> arguments_of(const std::vector<Option>& options, const json& given) {
  std::vector<std::string> arguments, positional;
  for (const Option& option : options) {
    const auto value = given.find(option.key());
    if (value == given.end()) continue;
    require_type(option, *value);
    if (option.is_flag()) {
      if (value->get<bool>()) arguments.push_back(option.label());
      continue;
    }
    for (const json& item : value->is_array() ? *value : json::array({*value}))
      if (option.positional)
        positional.push_back(json_text(item));
      else
        arguments.push_back(fmt::format("{}={}", option.label(), json_text(item)));
  }
  if (!positional.empty()) arguments.emplace_back("--");
  arguments.insert(arguments.end(), positional.begin(), positional.end());
  return arguments;
}

std::string default_output(const std::string& command) {
  static const std::map<std::string, std::string> names{
      {"simulate", "recording.h5"}, {"import", "recording.h5"},     {"calibrate", "camera"},
      {"label", "labels.h5"},       {"train", "model.safetensors"}, {"evaluate", "metrics.json"},
      {"report", "report.html"}};
  const auto name = names.find(command);
  return name == names.end() ? "output" : name->second;
}

}  // namespace touchtrace::sweep
