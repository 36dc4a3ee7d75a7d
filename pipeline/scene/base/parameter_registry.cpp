#include "pipeline/scene/base/parameter_registry.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/scene/base/parameter_rows.h"

namespace touchtrace::scene {
namespace {

/// Returns NaN if `text` is not a number.
double parse_number(const std::string& text) {
  double value = std::nan("");
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end ? value : std::nan("");
}

/// Positive finite number.
double parse_factor(const std::string& text) {
  const double factor = parse_number(text);
  if (factor > 0.0 && std::isfinite(factor)) return factor;
  throw usage_error(fmt::format("'x{}' is not a factor", text), "give e.g. glove-noise=x2");
}

std::string expected_form(const Parameter& parameter) {
  static const std::map<std::size_t, std::string> forms{
      {1, "VALUE"}, {2, "FROM:TO"}, {6, "FROM:TO:FROM:TO:FROM:TO along x, y and z"}};
  const std::size_t count = parameter.values().size();
  return fmt::format("give {}={}, {} from {:g} to {:g} {}", parameter.name, forms.at(count),
                     count == 1 ? "a number" : "numbers", parameter.min, parameter.max,
                     parameter.unit);
}

bool is_allowed(const Parameter& parameter, const std::vector<double>& values) {
  if (values.size() != parameter.values().size()) return false;
  for (double value : values)
    if (!(value >= parameter.min && value <= parameter.max)) return false;
  for (std::size_t i = 1; i < values.size(); i += 2)
    if (values[i] < values[i - 1]) return false;
  return true;
}

std::string join(const std::vector<double>& values) {
  std::string text;
  for (double value : values) text += fmt::format("{}{:g}", text.empty() ? "" : ":", value);
  return text;
}

std::string default_with_unit(const Parameter& parameter) {
  const std::string value = value_text(parameter, {});
  return parameter.unit.empty() ? value : value + " " + parameter.unit;
}

ParameterTable make_registry() {
  ParameterTable table;
  for (const auto add :
       {add_hand_parameters, add_activity_parameters, add_glove_parameters, add_camera_parameters})
    add(table);
  return table;
}

}  // namespace

const std::vector<Parameter>& parameter_registry() {
  static const ParameterTable table = make_registry();
  return table;
}

std::vector<double> Parameter::values(SceneParameters parameters) const {
  const auto span = numbers(parameters);
  return {span.begin(), span.end()};
}

const Parameter& find_parameter(const std::string& name) {
  std::vector<std::string> names;
  for (const Parameter& row : parameter_registry()) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw usage_error(fmt::format("unknown parameter '{}'", name),
                    nearest.empty() ? "`touchtrace parameters` lists all parameters"
                                    : fmt::format("did you mean '{}'?", nearest));
}

void set_parameter(SceneParameters& parameters, const std::string& setting) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos)
    throw usage_error(fmt::format("parameter setting '{}' is not NAME=VALUE", setting),
                      "`touchtrace parameters` lists the names");
  const Parameter& parameter = find_parameter(setting.substr(0, equals));
  const std::string value = setting.substr(equals + 1);
  if (value.starts_with('x'))
    return scale_parameter(parameters, parameter, parse_factor(value.substr(1)));
  std::vector<double> values;
  for (const std::string& text : split_text(value, ':')) values.push_back(parse_number(text));
  if (!is_allowed(parameter, values))
    throw usage_error(fmt::format("invalid value '{}' of {}", value, parameter.name),
                      expected_form(parameter));
  std::ranges::copy(values, parameter.numbers(parameters).begin());
}

SceneParameters parse_parameters(const std::vector<std::string>& settings) {
  SceneParameters parameters;
  for (const std::string& list : settings)
    for (const std::string& setting : split_text(list, ',')) set_parameter(parameters, setting);
  return parameters;
}

void scale_parameter(SceneParameters& parameters, const Parameter& parameter, double factor) {
  const auto values = parameter.numbers(parameters);
  const bool is_box = values.size() == std::tuple_size_v<Box>;
  for (std::size_t i = 0; i < values.size(); i += 2) {
    const double centre = is_box ? 0.5 * (values[i] + values[i + 1]) : 0.0;
    for (double& value : values.subspan(i, std::min<std::size_t>(2, values.size() - i)))
      value = std::clamp(centre + factor * (value - centre), parameter.min, parameter.max);
  }
}

std::string value_text(const Parameter& parameter, const SceneParameters& parameters) {
  return join(parameter.values(parameters));
}

nlohmann::json parameters_json(const SceneParameters& parameters) {
  nlohmann::json json;
  for (const Parameter& row : parameter_registry()) {
    const auto values = row.values(parameters);
    json[row.name] = values.size() == 1 ? nlohmann::json(values[0]) : nlohmann::json(values);
  }
  return json;
}

std::string markdown_table(const std::string& group) {
  std::string text =
      "| parameter | default | description | source | reason |\n|---|---|---|---|---|\n";
  for (const Parameter& row : parameter_registry())
    if (row.group == group)
      text += fmt::format("| {} | {} | {} | {} | {} |\n", row.name, default_with_unit(row),
                          row.description, row.source.empty() ? "-" : row.source, row.reason);
  return text;
}

}  // namespace touchtrace::scene
