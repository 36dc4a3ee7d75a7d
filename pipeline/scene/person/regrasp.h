#pragma once

#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {

/// Movement that changes how an object lies on the palm: the palm becomes level, the grip relaxes,
/// the fingers open a little, the palm tilts until the object has rolled or slid to a random place
/// and come to rest there; then the fingers grip and the hand tilts as before. Repeated while the
/// object is too far from the centre.
class Regrasp {
 public:
  Regrasp(const RegraspParameters& parameters, const ObjectSpec& object);

  /// Starts a regrasp with the probability `share`; never for an object so long that it would tip
  /// out.
  void maybe_start(double time_s, RandomStream& random);
  /// Called every control interval.
  void update(double time_s, const SceneSample& seen);

  bool is_done() const { return !busy_; }
  /// Whether the fingers are open, controlled by posture instead of force.
  bool is_open(double time_s) const;
  /// Fraction of the usual grip force and tilt.
  double grip_share(double time_s) const;
  double tilt_share(double time_s) const;
  /// Angles of the levelled palm about the forearm and the wrist.
  double roll_rad() const { return roll_rad_; }
  double pitch_rad() const { return pitch_rad_; }
  double posture_rad(int finger, double time_s) const;

 private:
  double open_s() const { return start_s_ + 2 * movement_s_; }
  void start(double time_s);
  void tilt_palm();

  RegraspParameters parameters_;
  const ObjectSpec& object_;
  bool is_possible_, busy_ = false;
  double start_s_ = -100.0, movement_s_ = 1.0, wait_s_ = 0.0, close_s_ = -100.0;
  double opening_rad_ = 0.0;
  Eigen::Vector2d target_m_ = Eigen::Vector2d::Zero(), level_error_rad_ = target_m_;
  Eigen::Vector2d felt_m_ = target_m_, felt_m_per_s_ = target_m_;
  double roll_rad_ = 0.0, pitch_rad_ = 0.0;
  std::array<double, num_fingers> held_rad_{};  ///< flexion before the fingers opened
};

}  // namespace touchtrace::scene
