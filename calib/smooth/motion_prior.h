#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace touchtrace {

template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// One axis of a motion over a stretch of time, x = (position, velocity, acceleration):
///     x+ = F x + g u + w,  w ~ N(0, j Q + Q_free),  g: gravity along the axis.
/// j, how freely the body moves just then, is 1 unless something says more: Q is the noise of
/// touch, Q_free that of flights and of what is near their ends. Of the correlated part of a
/// measurement's error `error_kept` is left, and the rest is new. Scalars are double, or Jet where
/// Ceres wants derivatives.
template <class T>
struct Transition {
  Matrix3<T> F = Matrix3<T>::Identity(), Q = Matrix3<T>::Zero();
  Eigen::Matrix<T, 3, 1> u = Eigen::Matrix<T, 3, 1>::Zero();
  Matrix3<T> Q_free = Matrix3<T>::Zero();
  T error_kept{1.0};

  Transition then(const Transition& next) const {
    return {next.F * F, next.F * Q * next.F.transpose() + next.Q, next.F * u + next.u,
            next.F * Q_free * next.F.transpose() + next.Q_free, error_kept * next.error_kept};
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

/// The same with noise that does not depend on j.
template <class T>
Transition<T> free_of_j(Transition<T> step) {
  std::swap(step.Q, step.Q_free);
  return step;
}

/// How freely a body moves. Units of Track: metres and seconds.
template <class T>
struct MotionNoise {
  T jerk_density{300.0};     ///< while held or touched [m^2/s^5]; a hand has 100 to 500
  T measurement_scale{1.0};  ///< of white errors: the deviations of measurements over the track's
  /// The same of errors that neighbours have in common, but no more than of the median deviation
  /// of the track's axis: what a measurement is uncertain by beyond that is its own. e^(-t /
  /// correlation_s) of one is left after t; such errors of rendered labels have 0.15 to 1.6 s.
  T correlated_scale{0.0}, correlation_s{0.3};
  /// Velocity swings around zero with this frequency and damping ratio: a hand stays in reach. At 0
  /// it is free, and the prior is white noise on jerk alone.
  T swing_rad_per_s{0.0}, swing_damping{1.0};
  /// In touch, but within `throw_s` of a flight: nothing that a hand does is as sudden as throwing
  /// and catching.
  T throw_jerk_density{1000.0}, throw_s{0.2};
  T flight_drag_per_s{0.05};                    ///< deceleration in flight, of the velocity
  T landing_velocity_m_per_s{0.5};              ///< after a landing: deviation from what is kept
  double flight_jerk_density = 0.01;            ///< in flight, beyond drag [m^2/s^5]
  double flight_acceleration_m_per_s2 = 0.1;    ///< deviation from gravity and drag: tilt
  double landing_kept = 0.5;                    ///< of the velocity: none to all, a hand gives way
  double landing_acceleration_m_per_s2 = 10.0;  ///< deviation from none after a landing
  /// Of the mean jerk: what the course of the jerk tends to where little is known of it.
  double usual_jerk_share = 0.1;

  /// Is never held: it is hit, and turns round.
  bool bounces() const { return landing_kept < 0.0; }

  /// What white and correlated errors leave of the variances of measurements, of 1.
  T left_share() const {
    const T told = measurement_scale * measurement_scale + correlated_scale * correlated_scale;
    return told < T(1) ? T(1) - told : T(0);
  }

  template <class U>
  MotionNoise<U> cast() const {
    return {U(jerk_density),       U(measurement_scale),
            U(correlated_scale),   U(correlation_s),
            U(swing_rad_per_s),    U(swing_damping),
            U(throw_jerk_density), U(throw_s),
            U(flight_drag_per_s),  U(landing_velocity_m_per_s),
            flight_jerk_density,   flight_acceleration_m_per_s2,
            landing_kept,          landing_acceleration_m_per_s2,
            usual_jerk_share};
  }
};

/// A ball is light enough for drag, and turns round at every hit. Drag goes by the square of the
/// velocity: at 2.2 m/s the linear one is 0.15 m/s^2 off, and changes by 0.2 m/s^2 in the 0.45 s of
/// a flight, as noise of 0.2^2 / 0.45 m^2/s^5 does.
inline MotionNoise<double> bouncing_ball() {
  MotionNoise<double> noise;
  noise.flight_drag_per_s = 0.2;
  noise.flight_jerk_density = 0.1;
  noise.flight_acceleration_m_per_s2 = 0.15;
  noise.landing_kept = -1.0;
  noise.landing_velocity_m_per_s = 1.0;
  noise.landing_acceleration_m_per_s2 = 15.0;
  return noise;
}

/// jerk = -w^2 v - 2 z w a + white noise for `h` seconds: the series of exp(A h) and of its noise
/// over a part of h that is short for w, doubled until it is h.
template <class T>
Transition<T> swinging(const T& h, const MotionNoise<T>& noise) {
  constexpr int terms = 12;
  const T &w = noise.swing_rad_per_s, &z = noise.swing_damping;
  const T pull = -w * w, damping = -2.0 * z * w;
  const auto changed = [&](const Matrix3<T>& x) {  // A x
    Matrix3<T> result;
    result << x.row(1), x.row(2), pull * x.row(1) + damping * x.row(2);
    return result;
  };
  Matrix3<T> f = Matrix3<T>::Identity(), q = Matrix3<T>::Zero();
  int doublings = 0;
  T part = h;
  for (; w * (1.0 + 2.0 * z) * part > T(0.5); ++doublings) part /= 2.0;
  q(2, 2) = noise.jerk_density * part;
  Transition<T> step;
  step.Q = q;
  for (int k = 1; k < terms; ++k) {
    const Matrix3<T> aq = changed(q);
    f = changed(f) * (part / double(k));
    q = (aq + aq.transpose()) * (part / double(k + 1));
    step.F += f, step.Q += q;
  }
  for (; doublings > 0; --doublings) step = step.then(step);
  return step;
}

/// Free flight but for gravity: jerk = -drag a + white noise, as it follows from v' = g - drag v.
/// The series of exp(-drag h) is good to (drag h)^4 / 24.
template <class T>
Transition<T> flying(const T& h, const MotionNoise<T>& noise) {
  auto step = white_jerk(h, T(noise.flight_jerk_density));
  const T x = -noise.flight_drag_per_s * h, third = 1.0 + x / 3.0 * (1.0 + x / 4.0),
          half = 1.0 + x / 2.0 * third;
  step.F(0, 2) *= third, step.F(1, 2) *= half, step.F(2, 2) = 1.0 + x * half;
  return free_of_j(step);
}

/// Contact ends (the acceleration becomes gravity) or begins (of the velocity a part is left, the
/// acceleration is a new one).
template <class T>
struct ContactEvent {
  T time;
  bool release;
};

/// The prior of a motion with flights: swinging or white jerk while touched, gravity between
/// release and landing.
template <class T>
class MotionPrior {
 public:
  /// `events` in order of time, release and landing in turn.
  MotionPrior(const MotionNoise<T>& noise, const std::vector<ContactEvent<T>>& events)
      : noise_(noise) {
    const T& reach = noise.throw_s;
    const auto rests_before = [&](std::size_t i) {
      return i == 0 || i == events.size() || events[i - 1].time + reach < events[i].time - reach;
    };
    for (std::size_t i = 0; i < events.size(); ++i) {
      const auto& [time, release] = events[i];
      if (release && rests_before(i)) turns_.push_back({time - reach, Mode::throwing});
      const Mode mode = release ? Mode::flying : Mode::throwing;
      turns_.push_back({time, mode, mode});
      if (!release && rests_before(i + 1)) turns_.push_back({time + reach, Mode::held});
    }
  }

  /// From `from` to `to` >= `from`; an event at `to` is part of it, one at `from` is not.
  Transition<T> between(double from, double to) const {
    using std::exp;
    auto step = moved(from, to);
    if (noise_.correlated_scale > T(0)) step.error_kept = exp((from - to) / noise_.correlation_s);
    return step;
  }

  /// For `h` seconds in touch.
  Transition<T> touched(const T& h) const {
    return noise_.swing_rad_per_s > T(0) ? swinging(h, noise_) : white_jerk(h, noise_.jerk_density);
  }

  const MotionNoise<T>& noise() const { return noise_; }

 private:
  enum class Mode { held, throwing, flying };
  /// What a motion is from a time on; a flight begins and ends with a jump.
  struct Turn {
    T time;
    Mode mode, jump = Mode::held;
  };

  Transition<T> moved(double from, double to) const {
    auto turn = std::upper_bound(turns_.begin(), turns_.end(), T(from),
                                 [](const T& t, const Turn& e) { return t < e.time; });
    Mode mode = turn == turns_.begin() ? Mode::held : std::prev(turn)->mode;
    if (turn == turns_.end() || T(to) < turn->time) return during(mode, T(to - from));
    Transition<T> total;
    T now(from);
    for (; turn != turns_.end() && !(T(to) < turn->time); ++turn) {
      total = total.then(during(mode, turn->time - now)).then(jump(turn->jump));
      mode = turn->mode;
      now = turn->time;
    }
    return total.then(during(mode, T(to) - now));
  }

  Transition<T> during(Mode mode, const T& h) const {
    if (mode == Mode::held) return touched(h);
    if (mode == Mode::throwing) return free_of_j(white_jerk(h, noise_.throw_jerk_density));
    return flying(h, noise_);
  }

  Transition<T> jump(Mode into) const {
    const auto square = [](const auto& s) { return T(s * s); };
    Transition<T> step;
    if (into == Mode::held) return step;
    step.F(2, 2) = T(0);
    if (into == Mode::flying) {
      step.u[2] = T(1);
      step.F(2, 1) = -noise_.flight_drag_per_s;
      step.Q_free(2, 2) = square(noise_.flight_acceleration_m_per_s2);
    } else {
      step.F(1, 1) = T(noise_.landing_kept);
      step.Q_free(1, 1) = square(noise_.landing_velocity_m_per_s);
      step.Q_free(2, 2) = square(noise_.landing_acceleration_m_per_s2);
    }
    return step;
  }

  MotionNoise<T> noise_;
  std::vector<Turn> turns_;
};

}  // namespace touchtrace
