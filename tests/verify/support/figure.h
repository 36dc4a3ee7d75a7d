#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// Line plot of a figure, such as error over run time.
struct Picture {
  struct Curve {
    std::string name;
    std::vector<double> x, y;
  };

  std::string x_label, y_label;  ///< with units
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

/// Measured quantity with its goal: one row of `touchtrace-verify AREA`.
struct Figure {
  enum class Goal { at_most, at_least, within, reported };

  std::string name, unit;
  double value;
  Goal goal = Goal::reported;
  double low = 0.0, high = 0.0;  ///< at_most: high; at_least: low; within: both; reported: none
  double seconds = 0.0;          ///< duration of the measurement
  std::optional<Picture> picture = std::nullopt;  ///< for --report

  /// Whether `value` meets the goal. False for NaN and infinity, also if only reported.
  bool passes() const;
  /// "<= 0.24", ">= 2", "0.95 to 1.05" or "reported"
  std::string goal_text() const;
};

Figure at_most(std::string name, double value, std::string unit, double high);
Figure at_least(std::string name, double value, std::string unit, double low);
Figure within(std::string name, double value, std::string unit, double low, double high);
/// A figure without a goal.
Figure reported(std::string name, double value, std::string unit);

/// {"figures": [{"name", "value", "unit", "goal", "holds", "seconds", "picture"}...]}. "holds" is
/// passes(); "value" is null if not finite; "picture" exists only if the figure has one, with the
/// member names of Picture.
nlohmann::json to_json(const std::vector<Figure>& figures);

/// Measures the figures of an area and calls `emit` for each as soon as it is known.
using Verification = std::function<void(const std::function<void(Figure)>& emit)>;

}  // namespace touchtrace
