#pragma once

#include <span>

#include "pipeline/scene/physics/ball.h"
#include "pipeline/scene/physics/contact.h"

namespace touchtrace::scene {

/// How one finger's first joint is driven: torque + stiffness (rest - flexion).
struct FingerDrive {
  double torque_nm = 0.0, stiffness_nm_per_rad = 0.0, rest_rad = 0.0;
};

/// theta of a step: at least `least`, and up to `most` where contacts are too stiff for the step.
/// {1, 1} is implicit Euler, {0.5, 0.5} the implicit midpoint rule.
struct Implicitness {
  double least = 0.5, most = 1.0;
};

/// What the body wants during one control interval; the wanted hand accelerates uniformly within
/// it.
struct Drive {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), velocity_m_per_s = Eigen::Vector3d::Zero(),
                  acceleration_m_per_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();  ///< of the hand, imposed
  double carried_weight_n = 0.0;                                         ///< fed forward, upwards
  std::array<FingerDrive, finger_count> fingers;
};

/// Hand (translation), object (rigid) and five finger joints, solved together: 14 velocities. The
/// hand's orientation is imposed by the drive.
///
/// One step of h solves for the mean velocities v, M (v - u) = theta h f(q + theta h v, v), with f
/// linearized about where everything gets in (1 - theta) h with the present velocities u, and goes
/// on with q' = q + h v, u' = u + (v - u) / theta. theta is 1/2, the implicit midpoint rule of
/// second order, unless the contacts are too stiff for the step: then it tends to 1, implicit
/// Euler, which damps them. Momentum, and angular momentum in flight, are kept exactly; flight is
/// exact.
class World {
 public:
  explicit World(const ObjectSpec& object, const ArmParameters& arm = {},
                 const ContactParameters& contact = {}, const Implicitness& implicitness = {},
                 const FingerParameters& fingers = {}, const HandModel& model = hand_model());

  /// One control interval in as many steps as its events need: `step_s` at most while anything
  /// touches, finer in impacts, to the soonest contact in free flight; an impact of the ball ends a
  /// step. Deterministic.
  void advance(const Drive& drive, double interval_s, double step_s = 0.002);
  /// Exactly one step; the ball meets nothing.
  void step(const Drive& drive, double h);

  RigidState hand, object;
  std::optional<RigidState> ball;  ///< once it is in play
  double restitution = 1.0;        ///< of its next impact
  std::array<double, finger_count> flexion_rad{}, flexion_rate_rad_per_s{};

  /// Of the hand on the object, mean over the last advance().
  const Eigen::Vector3d& mean_force_n() const { return mean_force_n_; }
  /// Of the hand on the object in the last step; world.
  Eigen::Vector3d force_on_object_n() const;
  /// Of ball and object in the last advance(), in order of time.
  struct TimedImpact : Impact {
    double after_s;  ///< since the interval began
  };
  std::span<const TimedImpact> impacts() const { return impacts_; }
  const ObjectSpec& spec() const { return object_spec_; }
  const ContactPatch& contact() const { return contact_; }
  const HandModel& model() const { return *model_; }

 private:
  struct Instant;

  void add_masses(const Instant& at, MotionSystem& system) const;
  void add_arm(const Drive& drive, const Instant& at, MotionSystem& system) const;
  void add_fingers(const Drive& drive, const Instant& at, MotionSystem& system) const;
  double implicitness(double h) const;
  void note_rates(const MotionSystem& masses, const MotionSystem& system, double ahead_s);
  void move(const Velocity& mean, const Instant& at, double h);
  double closing_m_per_s() const;
  double next_step(double step_s) const;
  double until_impact(double step_s) const;
  void meet_ball(double after_s);

  ObjectSpec object_spec_;
  Eigen::Matrix3d inverse_inertia_;
  ArmParameters arm_;
  const HandModel* model_;
  FingerParameters fingers_;
  Implicitness implicitness_;
  ContactPatch contact_;
  Eigen::Matrix3d world_from_contact_ = Eigen::Matrix3d::Identity();
  /// How fast contacts swing, squared, when there last were any: everything; the object alone.
  double contact_rate2_per_s2_, object_rate2_per_s2_;
  Velocity acceleration_ = Velocity::Zero();  ///< in the last step, the object's axes of then
  Eigen::Vector3d mean_force_n_ = Eigen::Vector3d::Zero();
  std::vector<TimedImpact> impacts_;
  double impact_left_s_ = 0.0;  ///< how long the last one still takes
};

}  // namespace touchtrace::scene
