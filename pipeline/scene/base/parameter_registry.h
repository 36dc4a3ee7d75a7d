#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pipeline/scene/base/parameters.h"

namespace touchtrace::scene {

/// Description of one member of SceneParameters: a number, an interval (from, to) or a box (from,
/// to along the world's x, y and z). The default is the member's initializer.
struct Parameter {
  std::string group, name, unit;  ///< `name` begins with `group` and a dash
  double min, max;                ///< of each number, both allowed
  std::string description;
  std::string source;  ///< publication or data sheet; empty: assumed
  std::string reason;  ///< of the value, as far as the source does not give it
  std::function<std::span<double>(SceneParameters&)> numbers;

  std::vector<double> values(SceneParameters parameters = {}) const;
};

/// All parameters of the simulated scene, by group. `touchtrace parameters` prints them.
const std::vector<Parameter>& parameter_registry();
/// Throws usage_error with the nearest name.
const Parameter& find_parameter(const std::string& name);

/// Applies "NAME=VALUE" with VALUE in the parameter's unit; an interval is FROM:TO. "NAME=xF" is
/// scale_parameter() by F. Throws usage_error for an unknown name, a wrong number of values, or a
/// value out of range.
void set_parameter(SceneParameters& parameters, const std::string& setting);

/// Returns the defaults with the settings applied. An element may hold several settings, separated
/// by commas.
SceneParameters parse_parameters(const std::vector<std::string>& settings);

/// Kind of glove. `settings` of its parameters as parse_parameters() takes them; empty: defaults.
struct GloveModel {
  std::string name;
  std::vector<std::string> settings;
};
const std::vector<GloveModel>& glove_models();
std::vector<std::string> glove_model_names();

/// Multiplies the parameter's numbers by `factor`, a box about its centre; clamps to the range.
void scale_parameter(SceneParameters& parameters, const Parameter& parameter, double factor);

/// "0.012" or "0.04:0.16": the VALUE of set_parameter().
std::string value_text(const Parameter& parameter, const SceneParameters& parameters);
/// {"glove-cross-talk": 0.012, "wave-amplitude": [0.04, 0.16], ...}
nlohmann::json parameters_json(const SceneParameters& parameters);
/// Markdown table of one group: name, default, description, source, reason.
std::string markdown_table(const std::string& group);

}  // namespace touchtrace::scene
