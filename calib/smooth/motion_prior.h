#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/smooth/motion_noise.h"

namespace touchtrace {

/// Number of states of an axis' motion: position, velocity, acceleration.
inline constexpr int motion_size = 3;

/// States of an axis: position, velocity, acceleration; then, if the track has flights, the
/// measured point's offset from the body and its derivative over MotionPrior::wander_rate.
enum class StateModel { contact, with_flights };
template <StateModel model>
inline constexpr int axis_state_size = model == StateModel::contact ? motion_size : motion_size + 2;

/// Transition of one axis over a time step:
///     x+ = F x + g u + w,  w ~ N(0, e^c Q + Q_fixed),  g: gravity along the axis.
/// c is the process noise curve (ProcessNoiseCurve) in this step, 0 if the noise is constant.
template <int size>
struct Transition {
  using Square = Eigen::Matrix<double, size, size>;
  Square F = Square::Identity(), Q = Square::Zero(), Q_fixed = Square::Zero();
  Eigen::Matrix<double, size, 1> u = Eigen::Matrix<double, size, 1>::Zero();

  /// This step followed by `next`.
  Transition then(const Transition& next) const {
    return {next.F * F, next.F * Q * next.F.transpose() + next.Q,
            next.F * Q_fixed * next.F.transpose() + next.Q_fixed, next.F * u + next.u};
  }
};

/// Motion in contact for `h` >= 0 seconds: position, velocity and acceleration under
/// jerk = -b^2 v - 2 b a + white noise of spectral density `density`. The velocity is a Matern
/// process of smoothness 3/2 (Hartikainen and Sarkka, Kalman filtering and smoothing solutions to
/// temporal Gaussian process regression models, 2010). Q is a sum of outer products (Gauss-Legendre
/// quadrature), so it is positive semidefinite and exact for short steps, too.
Transition<motion_size> contact_step(double h, double density, double bandwidth);

/// Release, after which the acceleration is gravity and drag and the measured point wanders, or
/// landing, which keeps a fraction of the velocity, resets the acceleration and ends the wander.
/// A landing and a release at one time are a hit, such as a bounce: it gives the body any velocity
/// and any spin and leaves the position of the measured point on it.
struct ContactEvent {
  double time;
  bool is_release;
};

/// Gaussian process prior of a motion with flights. In contact the velocity is a Matern process; in
/// flight there is gravity and drag, and the measured point wanders about the body. Its offset is
/// drawn at the release, as a hand that lets go uncovers other parts of the body, and constant in
/// contact, where it cannot be told from the body's motion. Times, lengths and noise in consistent
/// units.
template <StateModel model>
class MotionPrior {
 public:
  static constexpr int size = axis_state_size<model>;
  using Step = Transition<size>;

  /// `events`: ordered by time, releases and landings alternating, release first.
  /// `throw_duration`: duration of the throwing phases next to flights.
  explicit MotionPrior(const MotionNoise& noise = {}, const std::vector<ContactEvent>& events = {},
                       double throw_duration = 0.0);

  /// Transition from `from` to `to` >= `from`, with the events in (from, to].
  Step between(double from, double to) const;
  /// Transition of `duration` in contact.
  Step in_contact(double duration) const;
  /// States before the first measurement, at time 0, as a step from nothing. `flat`: standard
  /// deviation of the position, and limit of those of velocity and acceleration.
  Step initial(double flat) const;
  /// Rate of the wander: its derivative is this times its second state.
  double wander_rate() const;

 private:
  enum class Mode { contact, throwing, flight };
  enum class Jump { none, release, landing, hit };
  /// Change of the motion's mode. Flights begin and end with a jump of the state.
  struct ModeChange {
    double time;
    Mode mode;
    Jump jump;
  };

  Mode mode_at(double time) const;
  Step during(Mode mode, double duration) const;
  Step free_flight(double duration) const;
  Step jump(Jump kind) const;
  Step release() const;
  Step landing() const;
  Step hit() const;
  void add_wander(Step& step, double duration) const;

  MotionNoise noise_;
  std::vector<ModeChange> changes_;
};

}  // namespace touchtrace
