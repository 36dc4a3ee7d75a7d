#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene/base/assumptions.h"

namespace touchtrace::scene {

using AssumptionTable = std::vector<Assumption>;

// One file each: rows of the parts in it, in the order of SceneParameters.
void add_hand_assumptions(AssumptionTable& table);
void add_activities_assumptions(AssumptionTable& table);
void add_glove_assumptions(AssumptionTable& table);
void add_camera_assumptions(AssumptionTable& table);

/// Adds rows of one part.
template <class Part>
class AssumptionRows {
 public:
  AssumptionRows(AssumptionTable& table, std::string part, Part SceneParameters::*member)
      : table_(table), part_(std::move(part)), member_(member) {}

  template <class Value>
  void operator()(const char* name, Value Part::*value, const char* unit, double least, double most,
                  const char* meaning, const char* published, const char* reason) {
    table_.push_back({part_, part_ + "-" + name, unit, least, most, meaning, published, reason,
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

  AssumptionTable& table_;
  std::string part_;
  Part SceneParameters::*member_;
};

}  // namespace touchtrace::scene
