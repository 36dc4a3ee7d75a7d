#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace touchtrace {

template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// Transition of one axis over a time step, x = (position, velocity, acceleration):
///     x+ = F x + g u + w,  w ~ N(0, j Q + Q_fixed),  g: gravity along the axis.
/// j is the relative jerk covariance, 1 unless the noise varies with time. Q is the process noise
/// in contact; Q_fixed, which j does not scale, that in flight and near its ends. The correlated
/// part of a measurement error is multiplied by `error_decay`, plus new noise that keeps its
/// variance at 1. T is double, or ceres::Jet for derivatives.
template <class T>
struct Transition {
  Matrix3<T> F = Matrix3<T>::Identity(), Q = Matrix3<T>::Zero();
  Eigen::Matrix<T, 3, 1> u = Eigen::Matrix<T, 3, 1>::Zero();
  Matrix3<T> Q_fixed = Matrix3<T>::Zero();
  T error_decay{1.0};

  /// This step followed by `next`.
  Transition then(const Transition& next) const {
    return {next.F * F, next.F * Q * next.F.transpose() + next.Q, next.F * u + next.u,
            next.F * Q_fixed * next.F.transpose() + next.Q_fixed, error_decay * next.error_decay};
  }
};

/// White-noise jerk of spectral density `density` [m^2/s^5] for `h` seconds.
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

/// Moves the process noise of a step to Q_fixed.
template <class T>
Transition<T> with_fixed_noise(Transition<T> step) {
  std::swap(step.Q, step.Q_fixed);
  return step;
}

/// Noise parameters of a body's motion and its measurements, in metres and seconds.
template <class T>
struct MotionNoise {
  T jerk_density{300.0};     ///< in contact [m^2/s^5]; a hand has 100 to 500
  T measurement_scale{1.0};  ///< standard deviation of white errors over the track's sigma
  /// Standard deviation of correlated errors over the smaller of the track's sigma and the axis'
  /// median sigma: the excess of a sigma over the median counts as white. Their autocorrelation is
  /// e^(-t / correlation_time_s); labels of rendered scenes have 0.15 to 1.6 s.
  T correlated_scale{0.0}, correlation_time_s{0.3};
  /// Damped oscillation of the velocity around zero (a hand stays within reach): natural frequency
  /// and damping ratio. Frequency 0: white-noise jerk alone.
  T oscillator_rad_per_s{0.0}, oscillator_damping{1.0};
  /// In contact within `throw_duration_s` of a flight: throwing and catching are more abrupt than
  /// any other motion of a hand [m^2/s^5, s].
  T throw_jerk_density{1000.0}, throw_duration_s{0.2};
  T flight_drag_per_s{0.05};                        ///< linear drag: deceleration over velocity
  T landing_velocity_sigma_m_per_s{0.5};            ///< of the velocity after a landing
  double flight_jerk_density = 0.01;                ///< in flight, besides drag [m^2/s^5]
  double flight_acceleration_sigma_m_per_s2 = 0.1;  ///< around gravity and drag; covers tilt
  double landing_velocity_fraction =
      0.5;  ///< mean velocity ratio across a landing: a hand gives way
  double landing_acceleration_sigma_m_per_s2 = 10.0;  ///< around 0, after a landing
  /// Prior mean of the time-varying jerk covariance, as a fraction of its average over all tracks.
  double prior_jerk_fraction = 0.1;

  /// Whether the body is only hit, never held: landings reverse its velocity.
  bool is_bouncing() const { return landing_velocity_fraction < 0.0; }

  /// Fraction of the tracks' stated variance that neither white nor correlated errors explain.
  T unexplained_variance_fraction() const {
    const T explained = measurement_scale * measurement_scale + correlated_scale * correlated_scale;
    return explained < T(1) ? T(1) - explained : T(0);
  }

  template <class U>
  MotionNoise<U> cast() const {
    return {U(jerk_density),           U(measurement_scale),
            U(correlated_scale),       U(correlation_time_s),
            U(oscillator_rad_per_s),   U(oscillator_damping),
            U(throw_jerk_density),     U(throw_duration_s),
            U(flight_drag_per_s),      U(landing_velocity_sigma_m_per_s),
            flight_jerk_density,       flight_acceleration_sigma_m_per_s2,
            landing_velocity_fraction, landing_acceleration_sigma_m_per_s2,
            prior_jerk_fraction};
  }
};

/// Initial noise of a table-tennis ball, which has drag and reverses its velocity at every hit.
/// Drag is quadratic in the velocity: at 2.2 m/s the linear model is off by 0.15 m/s^2, which
/// changes by 0.2 m/s^2 during a flight of 0.45 s, as noise of 0.2^2 / 0.45 m^2/s^5 would.
inline MotionNoise<double> bouncing_ball() {
  MotionNoise<double> noise;
  noise.flight_drag_per_s = 0.2;
  noise.flight_jerk_density = 0.1;
  noise.flight_acceleration_sigma_m_per_s2 = 0.15;
  noise.landing_velocity_fraction = -1.0;
  noise.landing_velocity_sigma_m_per_s = 1.0;
  noise.landing_acceleration_sigma_m_per_s2 = 15.0;
  return noise;
}

/// Damped oscillation of the velocity for `h` seconds: jerk = -w^2 v - 2 z w a + white noise.
/// Taylor series of exp(A h) and of the noise integral over a step with w h (1 + 2 z) <= 0.5, then
/// doubled until it reaches h.
template <class T>
Transition<T> damped_oscillator(const T& h, const MotionNoise<T>& noise) {
  constexpr int num_terms = 12;
  const T &w = noise.oscillator_rad_per_s, &z = noise.oscillator_damping;
  const T stiffness = -w * w, damping = -2.0 * z * w;
  const auto times_a = [&](const Matrix3<T>& x) {  // A x
    Matrix3<T> result;
    result << x.row(1), x.row(2), stiffness * x.row(1) + damping * x.row(2);
    return result;
  };
  Matrix3<T> f = Matrix3<T>::Identity(), q = Matrix3<T>::Zero();
  int num_doublings = 0;
  T short_h = h;
  for (; w * (1.0 + 2.0 * z) * short_h > T(0.5); ++num_doublings) short_h /= 2.0;
  q(2, 2) = noise.jerk_density * short_h;
  Transition<T> step;
  step.Q = q;
  for (int k = 1; k < num_terms; ++k) {
    const Matrix3<T> aq = times_a(q);
    f = times_a(f) * (short_h / double(k));
    q = (aq + aq.transpose()) * (short_h / double(k + 1));
    step.F += f, step.Q += q;
  }
  for (; num_doublings > 0; --num_doublings) step = step.then(step);
  return step;
}

/// Free flight for `h` seconds, without gravity, which a release adds to the acceleration:
/// jerk = -drag a + white noise, from v' = g - drag v. exp(-drag h) is expanded up to
/// (drag h)^3; the error is (drag h)^4 / 24.
template <class T>
Transition<T> free_flight(const T& h, const MotionNoise<T>& noise) {
  auto step = white_jerk(h, T(noise.flight_jerk_density));
  const T x = -noise.flight_drag_per_s * h, third = 1.0 + x / 3.0 * (1.0 + x / 4.0),
          half = 1.0 + x / 2.0 * third;
  step.F(0, 2) *= third, step.F(1, 2) *= half, step.F(2, 2) = 1.0 + x * half;
  return with_fixed_noise(step);
}

/// Release, after which the acceleration is gravity and drag, or landing, which keeps a fraction of
/// the velocity and resets the acceleration.
template <class T>
struct ContactEvent {
  T time;
  bool is_release;
};

/// Gaussian process prior of a motion with flights: white-noise jerk or a damped oscillation in
/// contact, gravity and drag between release and landing.
template <class T>
class MotionPrior {
 public:
  /// `events`: ordered by time, releases and landings alternating, release first.
  MotionPrior(const MotionNoise<T>& noise, const std::vector<ContactEvent<T>>& events)
      : noise_(noise) {
    const T& margin = noise.throw_duration_s;
    // whether contact before event i lasts longer than both throwing phases around it
    const auto has_rest_before = [&](std::size_t i) {
      return i == 0 || i == events.size() || events[i - 1].time + margin < events[i].time - margin;
    };
    for (std::size_t i = 0; i < events.size(); ++i) {
      const auto& [time, is_release] = events[i];
      if (is_release && has_rest_before(i)) changes_.push_back({time - margin, Mode::throwing});
      const Mode mode = is_release ? Mode::flight : Mode::throwing;
      changes_.push_back({time, mode, mode});
      if (!is_release && has_rest_before(i + 1)) changes_.push_back({time + margin, Mode::contact});
    }
  }

  /// Transition from `from` to `to` >= `from`, with the events in (from, to].
  Transition<T> between(double from, double to) const {
    using std::exp;
    auto step = motion_between(from, to);
    if (noise_.correlated_scale > T(0))
      step.error_decay = exp((from - to) / noise_.correlation_time_s);
    return step;
  }

  /// Transition of `h` seconds in contact.
  Transition<T> in_contact(const T& h) const {
    return noise_.oscillator_rad_per_s > T(0) ? damped_oscillator(h, noise_)
                                              : white_jerk(h, noise_.jerk_density);
  }

  const MotionNoise<T>& noise() const { return noise_; }

 private:
  enum class Mode { contact, throwing, flight };
  /// Change of the motion's mode. Flights begin and end with a jump of the state; jump `contact`
  /// means none.
  struct ModeChange {
    T time;
    Mode mode, jump = Mode::contact;
  };

  Transition<T> motion_between(double from, double to) const {
    auto change =
        std::upper_bound(changes_.begin(), changes_.end(), T(from),
                         [](const T& t, const ModeChange& next) { return t < next.time; });
    Mode mode = change == changes_.begin() ? Mode::contact : std::prev(change)->mode;
    if (change == changes_.end() || T(to) < change->time) return during(mode, T(to - from));
    Transition<T> total;
    T now(from);
    for (; change != changes_.end() && !(T(to) < change->time); ++change) {
      total = total.then(during(mode, change->time - now)).then(jump(change->jump));
      mode = change->mode;
      now = change->time;
    }
    return total.then(during(mode, T(to) - now));
  }

  Transition<T> during(Mode mode, const T& h) const {
    if (mode == Mode::contact) return in_contact(h);
    if (mode == Mode::throwing) return with_fixed_noise(white_jerk(h, noise_.throw_jerk_density));
    return free_flight(h, noise_);
  }

  Transition<T> jump(Mode into) const {
    const auto square = [](const auto& s) { return T(s * s); };
    Transition<T> step;
    if (into == Mode::contact) return step;
    step.F(2, 2) = T(0);
    if (into == Mode::flight) {
      step.u[2] = T(1);
      step.F(2, 1) = -noise_.flight_drag_per_s;
      step.Q_fixed(2, 2) = square(noise_.flight_acceleration_sigma_m_per_s2);
    } else {
      step.F(1, 1) = T(noise_.landing_velocity_fraction);
      step.Q_fixed(1, 1) = square(noise_.landing_velocity_sigma_m_per_s);
      step.Q_fixed(2, 2) = square(noise_.landing_acceleration_sigma_m_per_s2);
    }
    return step;
  }

  MotionNoise<T> noise_;
  std::vector<ModeChange> changes_;
};

}  // namespace touchtrace
