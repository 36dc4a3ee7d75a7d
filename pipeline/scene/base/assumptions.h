#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pipeline/scene/base/parameters.h"

namespace touchtrace::scene {

/// A number of the scene that nobody measured on this hand, arm and glove, or the few of an
/// interval (from, to) or of a box (from, to along x, y and z).
struct Assumption {
  std::string part, name, unit;  ///< the name begins with the part
  double least, most;            ///< of each number, both allowed
  std::string meaning;
  std::string published;  ///< "no", or what of it is, and where
  std::string reason;
  std::function<std::span<double>(SceneParameters&)> numbers;

  std::vector<double> of(SceneParameters parameters) const;
};

/// Every assumption, part after part: one row each in the files assumptions_of_*.cpp.
const std::vector<Assumption>& assumptions();
/// Throws usage_error with the nearest name.
const Assumption& find_assumption(const std::string& name);

/// Sets what "NAME=VALUE" says, VALUE in the assumption's unit; an interval as FROM:TO. Throws
/// usage_error for an unknown name, a wrong count of numbers, or one out of range.
void assume(SceneParameters& parameters, const std::string& setting);

/// The defaults but for such settings, or lists of them with commas between.
SceneParameters assumed(const std::vector<std::string>& settings);

/// Multiplies an assumption's numbers, a box about its middle, as far as their range allows.
void scale(SceneParameters& parameters, const Assumption& assumption, double factor);

/// "0.012", "0.04:0.16": what `assume` takes.
std::string value_text(const Assumption& assumption, const SceneParameters& parameters);
/// {"glove-cross-talk": 0.012, "wave-amplitude": [0.04, 0.16], ...}
nlohmann::json values_json(const SceneParameters& parameters);
/// A Markdown table of the defaults of one part.
std::string markdown_table(const std::string& part);

}  // namespace touchtrace::scene
