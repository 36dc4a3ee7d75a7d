#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene/base/parameter_registry.h"

namespace touchtrace::scene {

using ParameterTable = std::vector<Parameter>;

// One file each (parameters_*.cpp); groups in the order of SceneParameters.
void add_hand_parameters(ParameterTable& table);
void add_activity_parameters(ParameterTable& table);
void add_glove_parameters(ParameterTable& table);
void add_camera_parameters(ParameterTable& table);

/// Appends the rows of one group, a member of SceneParameters.
template <class Group>
class ParameterRows {
 public:
  ParameterRows(ParameterTable& table, std::string group, Group SceneParameters::*member)
      : table_(table), group_(std::move(group)), member_(member) {}

  /// A row needs `source` or `reason`; if `source` ends with "(form only)", both.
  template <class Value>
  void operator()(const char* name, Value Group::*value, const char* unit, double min, double max,
                  const char* description, const char* source, const char* reason) {
    table_.push_back({group_, group_ + "-" + name, unit, min, max, description, source, reason,
                      [member = member_, value](SceneParameters& parameters) {
                        return numbers_in(parameters.*member.*value);
                      }});
  }

 private:
  static std::span<double> numbers_in(double& value) { return {&value, 1}; }
  template <std::size_t Size>
  static std::span<double> numbers_in(std::array<double, Size>& values) {
    return values;
  }

  ParameterTable& table_;
  std::string group_;
  Group SceneParameters::*member_;
};

}  // namespace touchtrace::scene
