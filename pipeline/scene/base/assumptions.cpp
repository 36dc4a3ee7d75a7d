#include "pipeline/scene/base/assumptions.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/scene/base/assumption_rows.h"

namespace touchtrace::scene {
namespace {

double number_of(const std::string& text) {
  double value = std::nan("");
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end ? value : std::nan("");
}

/// "0 to 1", and three such of a box.
std::string wanted_form(const Assumption& assumption) {
  static const std::map<std::size_t, std::string> forms{
      {1, "VALUE"}, {2, "FROM:TO"}, {6, "FROM:TO:FROM:TO:FROM:TO along x, y and z"}};
  return fmt::format("give {}={}, each from {:g} to {:g} {}", assumption.name,
                     forms.at(assumption.of({}).size()), assumption.least, assumption.most,
                     assumption.unit);
}

bool allowed(const Assumption& assumption, const std::vector<double>& values) {
  if (values.size() != assumption.of({}).size()) return false;
  for (double value : values)
    if (!(value >= assumption.least && value <= assumption.most)) return false;
  for (std::size_t i = 1; i < values.size(); i += 2)
    if (values[i] < values[i - 1]) return false;
  return true;
}

std::string joined(const std::vector<double>& values) {
  std::string text;
  for (double value : values) text += fmt::format("{}{:g}", text.empty() ? "" : ":", value);
  return text;
}

std::string with_unit(const Assumption& assumption) {
  const std::string value = value_text(assumption, {});
  return assumption.unit.empty() ? value : value + " " + assumption.unit;
}

AssumptionTable all_rows() {
  AssumptionTable table;
  for (const auto add : {add_hand_assumptions, add_activities_assumptions, add_glove_assumptions,
                         add_camera_assumptions})
    add(table);
  return table;
}

}  // namespace

const std::vector<Assumption>& assumptions() {
  static const AssumptionTable table = all_rows();
  return table;
}

std::vector<double> Assumption::of(SceneParameters parameters) const {
  const auto values = numbers(parameters);
  return {values.begin(), values.end()};
}

const Assumption& find_assumption(const std::string& name) {
  std::vector<std::string> names;
  for (const Assumption& row : assumptions()) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw usage_error(fmt::format("there is no assumption '{}'", name),
                    nearest.empty() ? "see `touchtrace assumptions`"
                                    : fmt::format("did you mean '{}'?", nearest));
}

void assume(SceneParameters& parameters, const std::string& setting) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos)
    throw usage_error(fmt::format("'{}' is no NAME=VALUE", setting),
                      "see `touchtrace assumptions` for the names");
  const Assumption& assumption = find_assumption(setting.substr(0, equals));
  std::vector<double> values;
  for (const std::string& text : split_text(setting.substr(equals + 1), ':'))
    values.push_back(number_of(text));
  if (!allowed(assumption, values))
    throw usage_error(fmt::format("{} cannot be '{}'", assumption.name, setting.substr(equals + 1)),
                      wanted_form(assumption));
  std::ranges::copy(values, assumption.numbers(parameters).begin());
}

SceneParameters assumed(const std::vector<std::string>& settings) {
  SceneParameters parameters;
  for (const std::string& list : settings)
    for (const std::string& setting : split_text(list, ',')) assume(parameters, setting);
  return parameters;
}

void scale(SceneParameters& parameters, const Assumption& assumption, double factor) {
  const auto values = assumption.numbers(parameters);
  const bool box = values.size() == std::tuple_size_v<Box>;
  for (std::size_t i = 0; i < values.size(); i += 2) {
    const double middle = box ? 0.5 * (values[i] + values[i + 1]) : 0.0;
    for (double& value : values.subspan(i, std::min<std::size_t>(2, values.size() - i)))
      value = std::clamp(middle + factor * (value - middle), assumption.least, assumption.most);
  }
}

std::string value_text(const Assumption& assumption, const SceneParameters& parameters) {
  return joined(assumption.of(parameters));
}

nlohmann::json values_json(const SceneParameters& parameters) {
  nlohmann::json values;
  for (const Assumption& row : assumptions()) {
    const auto numbers = row.of(parameters);
    values[row.name] = numbers.size() == 1 ? nlohmann::json(numbers[0]) : nlohmann::json(numbers);
  }
  return values;
}

std::string markdown_table(const std::string& part) {
  std::string text =
      "| assumption | value | meaning | published? | reason |\n|---|---|---|---|---|\n";
  for (const Assumption& row : assumptions())
    if (row.part == part)
      text += fmt::format("| {} | {} | {} | {} | {} |\n", row.name, with_unit(row), row.meaning,
                          row.published, row.reason);
  return text;
}

}  // namespace touchtrace::scene
