#include <fmt/core.h>

#include <numbers>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/scene/activity.h"

namespace touchtrace::scene {

const std::vector<ActivityRow>& activities() {
  static const std::vector<ActivityRow> table{
      {"wave", "the object is held and waved to and fro", 0.002, make_wave},
      {"throw", "the object is tossed off the open palm and caught", 0.002, make_throw},
  };
  return table;
}

std::vector<std::string> activity_names() {
  std::vector<std::string> names;
  for (const ActivityRow& row : activities()) names.push_back(row.name);
  return names;
}

const ActivityRow& find_activity(const std::string& name) {
  for (const ActivityRow& row : activities())
    if (row.name == name) return row;
  throw usage_error(fmt::format("there is no activity '{}'", name),
                    suggestion(name, activity_names()));
}

Eigen::Quaterniond palm_up(double roll_rad, double pitch_rad, double yaw_rad) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double fingers_away = -std::numbers::pi / 2;
  return AngleAxisd(yaw_rad + fingers_away, Vector3d::UnitZ()) *
         AngleAxisd(pitch_rad, Vector3d::UnitY()) * AngleAxisd(roll_rad, Vector3d::UnitX());
}

}  // namespace touchtrace::scene
