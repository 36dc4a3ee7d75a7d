#include "tests/verify/support/figure.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

namespace touchtrace {

bool Figure::passes() const {
  if (!std::isfinite(value)) return false;
  switch (goal) {
    case Goal::at_most:
      return value <= high;
    case Goal::at_least:
      return value >= low;
    case Goal::within:
      return value >= low && value <= high;
    case Goal::reported:
      return true;
  }
  return false;
}

std::string Figure::goal_text() const {
  switch (goal) {
    case Goal::at_most:
      return fmt::format("<= {:.6g}", high);
    case Goal::at_least:
      return fmt::format(">= {:.6g}", low);
    case Goal::within:
      return fmt::format("{:.6g} to {:.6g}", low, high);
    case Goal::reported:
      return "reported";
  }
  return {};
}

Figure at_most(std::string name, double value, std::string unit, double high) {
  return {std::move(name), std::move(unit), value, Figure::Goal::at_most, 0.0, high};
}

Figure at_least(std::string name, double value, std::string unit, double low) {
  return {std::move(name), std::move(unit), value, Figure::Goal::at_least, low, 0.0};
}

Figure within(std::string name, double value, std::string unit, double low, double high) {
  return {std::move(name), std::move(unit), value, Figure::Goal::within, low, high};
}

Figure reported(std::string name, double value, std::string unit) {
  return {std::move(name), std::move(unit), value};
}

namespace {

nlohmann::json to_json(const Picture& picture) {
  nlohmann::json curves = nlohmann::json::array();
  for (const auto& [name, x, y] : picture.curves)
    curves.push_back({{"name", name}, {"x", x}, {"y", y}});
  return {{"x_label", picture.x_label},
          {"y_label", picture.y_label},
          {"log_x", picture.log_x},
          {"log_y", picture.log_y},
          {"curves", std::move(curves)}};
}

}  // namespace

nlohmann::json to_json(const std::vector<Figure>& figures) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& figure : figures) {
    rows.push_back({{"name", figure.name},
                    {"value", std::isfinite(figure.value) ? nlohmann::json(figure.value) : nullptr},
                    {"unit", figure.unit},
                    {"goal", figure.goal_text()},
                    {"holds", figure.passes()},
                    {"seconds", figure.seconds}});
    if (figure.picture) rows.back()["picture"] = to_json(*figure.picture);
  }
  return {{"figures", std::move(rows)}};
}

}  // namespace touchtrace
