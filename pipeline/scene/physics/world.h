#pragma once

#include <span>

#include "pipeline/scene/physics/ball.h"
#include "pipeline/scene/physics/contact.h"

namespace touchtrace::scene {

/// Actuation of one finger's first joint: torque + stiffness (rest - flexion).
struct FingerDrive {
  double torque_nm = 0.0, stiffness_nm_per_rad = 0.0, rest_rad = 0.0;
};

/// Range of theta, the implicitness of a step: `min`, rising to `max` where contacts are too stiff
/// for the step. {0.5, 0.5} is the implicit midpoint rule, {1, 1} implicit Euler.
struct ThetaRange {
  double min = 0.5, max = 1.0;
};

/// Command for one control interval. The commanded hand position accelerates uniformly within it.
struct Drive {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), velocity_m_per_s = Eigen::Vector3d::Zero(),
                  acceleration_m_per_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();  ///< of the hand, imposed
  double carried_weight_n = 0.0;  ///< feed-forward force, upwards
  std::array<FingerDrive, num_fingers> fingers;
};

/// Physics of the hand (translation), the object (rigid body) and five finger joints, solved
/// together: 14 velocities. The hand's orientation is imposed by the drive. A ball, if any, is a
/// further body with impacts.
///
/// A step of h solves M (v - u) = theta h f(q + theta h v, v) for the mean velocities v, with f
/// linearized about the state extrapolated by (1 - theta) h with the present velocities u; then
/// q' = q + h v and u' = u + (v - u) / theta. theta is 1/2, the implicit midpoint rule of second
/// order, unless the contacts are too stiff for the step: then it tends to 1, implicit Euler, which
/// damps them. Momentum, and angular momentum in flight, are conserved exactly; flight is exact.
class World {
 public:
  explicit World(const ObjectSpec& object, const ArmParameters& arm = {},
                 const ContactParameters& contact = {}, const ThetaRange& theta = {},
                 const FingerParameters& fingers = {}, const HandModel& model = hand_model());

  /// Simulates one control interval in as many steps as its events need: `step_s` at most in
  /// contact, shorter in impacts, up to the soonest contact in free flight. An impact of the ball
  /// ends a step. Deterministic.
  void advance(const Drive& drive, double interval_s, double step_s = 0.002);
  /// Simulates exactly one step of `h`, without impacts of the ball.
  void step(const Drive& drive, double h);

  RigidState hand, object;
  std::optional<RigidState> ball;  ///< once it is in play
  double restitution = 1.0;        ///< of the ball's next impact
  std::array<double, num_fingers> flexion_rad{}, flexion_rate_rad_per_s{};

  /// Mean force of the hand on the object over the last advance(); world frame.
  const Eigen::Vector3d& mean_force_n() const { return mean_force_n_; }
  /// Force of the hand on the object in the last step; world frame.
  Eigen::Vector3d force_on_object_n() const;
  struct TimedImpact : Impact {
    double after_s;  ///< since the start of the interval
  };
  /// Impacts of the ball in the last advance(), ordered by time.
  std::span<const TimedImpact> impacts() const { return impacts_; }
  const ObjectSpec& spec() const { return object_spec_; }
  const ContactPatch& contact() const { return contact_; }
  const HandModel& model() const { return *model_; }

 private:
  struct Linearization;

  void add_masses(const Linearization& at, MotionSystem& system) const;
  void add_arm(const Drive& drive, const Linearization& at, MotionSystem& system) const;
  void add_fingers(const Drive& drive, const Linearization& at, MotionSystem& system) const;
  double theta(double h) const;
  void update_contact_rates(const MotionSystem& masses, const MotionSystem& system,
                            double implicit_s);
  void update_state(const Velocity& mean, const Linearization& at, double h);
  double closing_m_per_s() const;
  double choose_step_s(double max_step_s) const;
  double time_to_impact_s(double max_step_s) const;
  void resolve_impact(double after_s);

  ObjectSpec object_spec_;
  Eigen::Matrix3d inverse_inertia_;
  ArmParameters arm_;
  const HandModel* model_;
  FingerParameters fingers_;
  ThetaRange theta_;
  ContactPatch contact_;
  Eigen::Matrix3d world_from_contact_ = Eigen::Matrix3d::Identity();
  /// Squared natural frequencies of the last contacts: of all velocities, of the object's alone.
  double contact_rate2_per_s2_, object_rate2_per_s2_;
  /// Mean acceleration of the last step, in the object's body frame of that step.
  Velocity acceleration_ = Velocity::Zero();
  Eigen::Vector3d mean_force_n_ = Eigen::Vector3d::Zero();
  std::vector<TimedImpact> impacts_;
  double impact_left_s_ = 0.0;  ///< remaining duration of the last impact
};

}  // namespace touchtrace::scene
