#include "pipeline/label/track/grip.h"

#include <utility>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t grip_window_frames = 15;

}  // namespace

void Grip::add(const Eigen::Vector3d& object_from_hand_m) {
  if (last_.empty()) initial_distance_m_ = object_from_hand_m.norm();
  last_.push_back(object_from_hand_m);
  if (last_.size() > grip_window_frames) last_.erase(last_.begin());
}

Eigen::Vector3d Grip::object_from_hand_m() const {
  Eigen::Vector3d result;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& offset : last_) values.push_back(offset[axis]);
    result[axis] = median(std::move(values));
  }
  return result;
}

}  // namespace touchtrace::label
