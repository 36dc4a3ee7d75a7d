#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace touchtrace {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// One axis of a motion over a stretch of time, x = (position, velocity, acceleration):
///     x+ = F x + g u + w,  w ~ N(0, Q),  g: gravity along the axis.
/// Scalars are double, or Jet where Ceres wants derivatives.
template <class T>
struct Transition {
  Matrix3<T> F = Matrix3<T>::Identity(), Q = Matrix3<T>::Zero();
  Vector3<T> u = Vector3<T>::Zero();

  Transition then(const Transition& next) const {
    return {next.F * F, next.F * Q * next.F.transpose() + next.Q, next.F * u + next.u};
  }
};

/// White noise on jerk of spectral density `density` [m^2/s^5] for `h` seconds.
template <class T>
Transition<T> white_jerk(const T& h, const T& density) {
  const T h2 = h * h, h3 = h2 * h;
  Transition<T> step;
  step.F << T(1), h, h2 / 2.0, T(0), T(1), h, T(0), T(0), T(1);
  step.Q << h3 * h2 / 20.0, h2 * h2 / 8.0, h3 / 6.0,  //
      h2 * h2 / 8.0, h3 / 3.0, h2 / 2.0,              //
      h3 / 6.0, h2 / 2.0, h;
  step.Q *= density;
  return step;
}

/// How freely a body moves. Units of Track: metres and seconds.
template <class T>
struct MotionNoise {
  T jerk_density{1.0};                ///< while held or touched [m^2/s^5]
  T measurement_scale{1.0};           ///< the deviations of measurements are multiplied by it
  double flight_jerk_density = 0.01;  ///< in free flight [m^2/s^5]
  double flight_acceleration_m_per_s2 = 0.1;    ///< deviation from gravity in flight: drag, tilt
  double landing_velocity_m_per_s = 1.5;        ///< deviation of the jump at a landing
  double landing_acceleration_m_per_s2 = 15.0;  ///< likewise
};

/// Contact ends (the acceleration becomes gravity) or begins (velocity and acceleration jump).
template <class T>
struct ContactEvent {
  T time;
  bool release;
};

/// The prior of a motion with flights: white jerk while touched, gravity between release and
/// landing.
template <class T>
class MotionPrior {
 public:
  /// `events` in order of time, release and landing in turn.
  MotionPrior(const MotionNoise<T>& noise, std::vector<ContactEvent<T>> events)
      : noise_(noise), events_(std::move(events)) {}

  /// From `from` to `to` >= `from`; an event at `to` is part of it, one at `from` is not.
  Transition<T> between(double from, double to) const {
    auto event = std::upper_bound(events_.begin(), events_.end(), T(from),
                                  [](const T& t, const ContactEvent<T>& e) { return t < e.time; });
    bool flying = event != events_.begin() && std::prev(event)->release;
    if (event == events_.end() || T(to) < event->time) return touched_or_not(flying, T(to - from));
    Transition<T> total;
    T now(from);
    for (; event != events_.end() && !(T(to) < event->time); ++event) {
      total = total.then(touched_or_not(flying, event->time - now)).then(jump(event->release));
      flying = event->release;
      now = event->time;
    }
    return total.then(touched_or_not(flying, T(to) - now));
  }

  const MotionNoise<T>& noise() const { return noise_; }

 private:
  Transition<T> touched_or_not(bool flying, const T& h) const {
    return white_jerk(h, flying ? T(noise_.flight_jerk_density) : noise_.jerk_density);
  }

  Transition<T> jump(bool release) const {
    const auto square = [](double s) { return T(s * s); };
    Transition<T> step;
    if (release) {
      step.F(2, 2) = T(0);
      step.u[2] = T(1);
      step.Q(2, 2) = square(noise_.flight_acceleration_m_per_s2);
    } else {
      step.Q(1, 1) = square(noise_.landing_velocity_m_per_s);
      step.Q(2, 2) = square(noise_.landing_acceleration_m_per_s2);
    }
    return step;
  }

  MotionNoise<T> noise_;
  std::vector<ContactEvent<T>> events_;
};

/// The Kalman filter of one axis.
template <class T>
struct AxisState {
  Vector3<T> mean = Vector3<T>::Zero();
  Matrix3<T> covariance = Matrix3<T>::Zero();

  AxisState after(const Transition<T>& step, double gravity) const {
    return {step.F * mean + step.u * T(gravity), step.F * covariance * step.F.transpose() + step.Q};
  }

  /// Takes in a measured position (Joseph's form); returns -log of its likelihood, without the
  /// constant.
  T measure(double position, const T& variance) {
    using std::log;
    const T s = covariance(0, 0) + variance, innovation = T(position) - mean[0];
    const Vector3<T> gain = covariance.col(0) / s;
    Matrix3<T> keep = Matrix3<T>::Identity();
    keep.col(0) -= gain;
    mean += gain * innovation;
    covariance = (keep * covariance * keep.transpose() + gain * variance * gain.transpose()).eval();
    return 0.5 * (innovation * innovation / s + log(s));
  }
};

}  // namespace touchtrace
