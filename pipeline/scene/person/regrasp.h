#pragma once

#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {

/// Letting what lies on the palm come to lie otherwise: the palm becomes level, the grip gives way,
/// the fingers open a little, the palm makes the object roll or slide to a place drawn anew and
/// brings it to rest there; then the fingers grip again and the hand tilts as before. What lies too
/// far from the middle is let go once more.
class Regrasp {
 public:
  Regrasp(const RegraspParameters& parameters, const ObjectSpec& object);

  /// Begins one or not, never with what is so long that it would tip out.
  void consider(double time_s, RandomStream& random);
  /// Called once every control interval.
  void follow(double time_s, const SceneSample& seen);

  bool over() const { return !busy_; }
  /// Fingers by posture, not by force.
  bool loose(double time_s) const;
  /// Of the usual grip.
  double grip_share(double time_s) const;
  /// Of the usual tilt.
  double tilt_share(double time_s) const;
  /// Of the level palm about the forearm and the wrist.
  double roll_rad() const { return roll_rad_; }
  double pitch_rad() const { return pitch_rad_; }
  double posture_rad(int finger, double time_s) const;

 private:
  double open_s() const { return start_s_ + 2 * movement_s_; }
  void start(double time_s);
  void tilt_palm();

  RegraspParameters parameters_;
  const ObjectSpec& object_;
  bool possible_, busy_ = false;
  double start_s_ = -100.0, movement_s_ = 1.0, wait_s_ = 0.0, close_s_ = -100.0;
  double opening_rad_ = 0.0;
  Eigen::Vector2d wanted_m_ = Eigen::Vector2d::Zero(), level_error_rad_ = wanted_m_;
  Eigen::Vector2d felt_m_ = wanted_m_, felt_m_per_s_ = wanted_m_;
  double roll_rad_ = 0.0, pitch_rad_ = 0.0;
  std::array<double, finger_count> held_rad_{};  ///< before the fingers opened
};

}  // namespace touchtrace::scene
