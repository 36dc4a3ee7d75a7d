#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// A picture that goes with a figure: curves over common axes, such as error over run time.
struct Picture {
  struct Curve {
    std::string name;
    std::vector<double> x, y;
  };

  std::string x_label, y_label;  ///< with the unit
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

/// One figure that a room promises, measured: a row of `touchtrace-verify AREA`.
struct Figure {
  enum class Goal { at_most, at_least, within, reported };

  std::string name, unit;
  double value;
  Goal goal = Goal::reported;
  double low = 0.0, high = 0.0;  ///< at_most: high; at_least: low; within: both; reported: none
  double seconds = 0.0;          ///< spent on measuring it
  std::optional<Picture> picture = std::nullopt;  ///< for `verify --report`

  /// False for a value that is not finite, whatever the goal.
  bool holds() const;
  /// "<= 0.24", ">= 2", "0.95 to 1.05" or "reported"
  std::string goal_text() const;
};

Figure at_most(std::string name, double value, std::string unit, double high);
Figure at_least(std::string name, double value, std::string unit, double low);
Figure within(std::string name, double value, std::string unit, double low, double high);
Figure reported(std::string name, double value, std::string unit);

/// {"figures":[{"name","value","unit","goal","holds","seconds","picture"}...]}; a picture only
/// where there is one, with the names that Picture has.
nlohmann::json to_json(const std::vector<Figure>& figures);

/// Measures a room's figures, calling `emit` for each as soon as it is known.
using Verification = std::function<void(const std::function<void(Figure)>& emit)>;

}  // namespace touchtrace
