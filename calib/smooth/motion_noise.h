#pragma once

namespace touchtrace {

/// Parameters of a body's motion and its measurements.
struct MotionNoise {
  /// Spectral density of the jerk's white noise in contact [m^2/s^5]; a hand has 100 to 500. It is
  /// the mean of a density that may vary with time.
  double jerk_density = 300.0;
  /// Bandwidth of the velocity, which returns to zero: jerk = -b^2 v - 2 b a + noise. 0: white
  /// jerk.
  double bandwidth_rad_per_s = 3.0;
  double measurement_scale = 1.0;  ///< standard deviation of white errors over the track's sigma
  /// Jerk density within 0.2 s of a flight, over that of other contact.
  double throw_density_ratio = 4.0;
  double flight_drag_per_s = 0.05;                   ///< linear drag: deceleration over velocity
  double flight_acceleration_sigma_m_per_s2 = 0.15;  ///< around gravity and drag; covers tilt
  /// Standard deviation of the velocity around 0 after a hit and where a track begins in flight.
  double flight_velocity_sigma_m_per_s = 5.0;
  double flight_jerk_density = 0.01;  ///< of white noise in flight, besides drag [m^2/s^5]
  /// Mean ratio of the velocities after and before a landing, and standard deviation of the
  /// velocity about it: a hand yields as it catches.
  double landing_velocity_fraction = 0.5, landing_velocity_sigma_m_per_s = 0.7;
  double landing_acceleration_sigma_m_per_s2 = 10.0;  ///< around 0, after a landing
  /// Standard deviation of the measured point about the flying body (a marker or a visible surface
  /// turns with it), and the time in which it changes: a Matern process of smoothness 3/2, in
  /// flight alone.
  double wander_sigma_m = 0.002, wander_time_s = 0.25;

  /// Fraction of the track's stated variance that white errors leave unexplained.
  double unexplained_variance_fraction() const {
    return measurement_scale < 1.0 ? 1.0 - measurement_scale * measurement_scale : 0.0;
  }

  /// Fraction of the stated variance that neighbouring measurements share: the unexplained one, if
  /// it is more than white errors with long tails leave.
  double correlated_variance_fraction() const {
    constexpr double min_fraction = 0.25;
    const double fraction = unexplained_variance_fraction();
    return fraction < min_fraction ? 0.0 : fraction;
  }
};

}  // namespace touchtrace
