#include "pipeline/scene/person/regrasp.h"

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector2d;

constexpr double max_radius_m = 0.12;  // longer objects would tip out

/// Position of the object on the palm, relative to the usual grasp.
Vector2d position_on_palm_m(const ObjectSpec& object, const SceneSample& seen) {
  const RigidState &hand = seen.hand, &held = seen.object;
  const Eigen::Vector3d center = held.position_m + held.orientation * object.hold.center_m;
  return (hand.orientation.conjugate() * (center - hand.position_m)).head<2>() -
         grasp_center_m * Vector2d::UnitX();
}

}  // namespace

Regrasp::Regrasp(const RegraspParameters& parameters, const ObjectSpec& object)
    : parameters_(parameters),
      object_(object),
      is_possible_(bounding_radius_m(object) < max_radius_m) {}

void Regrasp::maybe_start(double time_s, RandomStream& random) {
  const RegraspParameters& p = parameters_;
  if (!is_possible_ || !(random.uniform() < p.share)) return;
  movement_s_ = draw(random, p.movement_s);
  wait_s_ = draw(random, p.wait_s);
  opening_rad_ = draw(random, p.opening_rad);
  target_m_ = p.place_m * Vector2d(random.normal(), random.normal());
  level_error_rad_ = p.tilt_rad * Vector2d(random.normal(), random.normal());
  busy_ = true;
  start(time_s);
}

void Regrasp::start(double time_s) {
  start_s_ = time_s;
  close_s_ = open_s() + wait_s_;
}

bool Regrasp::is_open(double time_s) const { return time_s > open_s() && time_s < close_s_; }

double Regrasp::grip_share(double time_s) const {
  return 1.0 - minimum_jerk_progress(time_s, start_s_ + movement_s_, movement_s_) +
         minimum_jerk_progress(time_s, close_s_, movement_s_);
}

double Regrasp::tilt_share(double time_s) const {
  return 1.0 - minimum_jerk_progress(time_s, start_s_, movement_s_) +
         minimum_jerk_progress(time_s, close_s_ + movement_s_, movement_s_);
}

double Regrasp::posture_rad(int finger, double time_s) const {
  return held_rad_[finger] - opening_rad_ * minimum_jerk_progress(time_s, open_s(), movement_s_);
}

void Regrasp::update(double time_s, const SceneSample& seen) {
  if (!busy_) return;
  const Vector2d place = position_on_palm_m(object_, seen);
  if (time_s <= start_s_ + movement_s_) felt_m_ = place;
  if (time_s <= open_s()) held_rad_ = seen.flexion_rad;
  felt_m_per_s_ = (place - felt_m_) / parameters_.reaction_s;
  felt_m_ += felt_m_per_s_ * control_interval_s;
  tilt_palm();
  if (time_s < close_s_ + movement_s_) return;
  busy_ = felt_m_.norm() > parameters_.max_offset_m;
  if (busy_) start(time_s - movement_s_);  // the palm is level already
}

/// Proportional-derivative control of the object's position on the palm.
void Regrasp::tilt_palm() {
  const RegraspParameters& p = parameters_;
  const Vector2d tilt = p.tilt_rad_per_m * (felt_m_ - target_m_) +
                        p.tilt_rad_s_per_m * felt_m_per_s_ + level_error_rad_;
  const Vector2d clamped = tilt.cwiseMax(-p.max_tilt_rad).cwiseMin(p.max_tilt_rad);
  roll_rad_ = clamped.y();
  pitch_rad_ = -clamped.x();
}

}  // namespace touchtrace::scene
