#include "calib/smooth/find_flights.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace touchtrace {
namespace {

constexpr std::array window_durations_s{0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5};
constexpr std::size_t min_samples = 5;
/// Flights before and after a hit overlap by this at most: noise hides the hit for a moment.
constexpr double max_overlap_s = 0.05;
constexpr std::size_t starts_per_window = 16;  // at most: bounds the work for dense samples
constexpr double normal_quantile = 3.0902;     // of 0.999
constexpr double max_misfit = 22.5;            // chi-square quantile of 0.999, 6 degrees of freedom

/// Standard deviations along an axis of the acceleration [m/s^2] and jerk [m/s^3], about gravity in
/// flight (tilt, drag) and about 0 in contact (RMS of recorded hands and mallets that accelerate
/// like gravity: 2 to 16 and 80 to 270).
const Eigen::Array2d flight_sigmas(0.15, 1.0), contact_sigmas(10.0, 100.0);
/// Logarithm of the least Bayes factor: of 100 000 windows in contact, one at most looks like a
/// flight by chance (Markov's inequality).
constexpr double min_log_bayes_factor = 11.5;

using Window = std::span<const TrackPoint>;

/// Chi-square quantile of 0.999 (Wilson and Hilferty 1931; error below 1 % from 9 degrees on).
double max_chi_square(double degrees_of_freedom) {
  const double variance = 2.0 / (9.0 * degrees_of_freedom);
  return degrees_of_freedom * std::pow(1.0 - variance + normal_quantile * std::sqrt(variance), 3.0);
}

/// Acceleration and jerk along one axis in a window's centre, by weighted least squares.
struct AxisFit {
  Eigen::Vector2d motion;
  Eigen::Matrix2d covariance;
  double chi_square;  ///< of the residuals
};

AxisFit fit_cubic(Window window, Eigen::Index axis) {
  const double center_s = 0.5 * (window.front().time_s + window.back().time_s);
  const auto row_of = [&](const TrackPoint& point) {
    const double t = point.time_s - center_s;
    return Eigen::Vector4d(Eigen::Vector4d(1.0, t, t * t / 2.0, t * t * t / 6.0) /
                           point.sigma_m[axis]);
  };
  const auto value_of = [&](const TrackPoint& point) {
    return (point.position_m[axis] - window.front().position_m[axis]) / point.sigma_m[axis];
  };
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  for (const auto& point : window) {
    information += row_of(point) * row_of(point).transpose();
    sums += row_of(point) * value_of(point);
  }
  const Eigen::Matrix4d covariance = information.inverse();
  const Eigen::Vector4d fit = covariance * sums;
  double chi_square = 0.0;
  for (const auto& point : window)
    chi_square += std::pow(value_of(point) - row_of(point).dot(fit), 2);
  return {fit.tail<2>(), covariance.bottomRightCorner<2, 2>(), chi_square};
}

/// Squared distance of a fit from `expected`, and the logarithm of the determinant of its
/// covariance, if the true values have standard deviations `sigmas`.
std::pair<double, double> misfit(const AxisFit& fit, const Eigen::Vector2d& expected,
                                 const Eigen::Array2d& sigmas) {
  Eigen::Matrix2d covariance = fit.covariance;
  covariance.diagonal() += sigmas.square().matrix();
  const Eigen::Vector2d error = fit.motion - expected;
  return {error.dot(covariance.inverse() * error), std::log(covariance.determinant())};
}

/// Whether the window is in flight; nullopt if it may be, but is too short to tell.
std::optional<bool> is_in_flight(Window window, const Eigen::Vector3d& gravity) {
  double chi_square = 0.0, flight_misfit = 0.0, log_bayes_factor = 0.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto fit = fit_cubic(window, axis);
    const auto [in_flight, flight_volume] = misfit(fit, {gravity[axis], 0.0}, flight_sigmas);
    const auto [in_contact, contact_volume] = misfit(fit, {0.0, 0.0}, contact_sigmas);
    chi_square += fit.chi_square, flight_misfit += in_flight;
    log_bayes_factor += 0.5 * (in_contact + contact_volume - in_flight - flight_volume);
  }
  const double degrees_of_freedom = 3.0 * static_cast<double>(window.size()) - 12.0;
  if (!(flight_misfit < max_misfit && chi_square < max_chi_square(degrees_of_freedom)))
    return false;
  return log_bayes_factor > min_log_bayes_factor ? std::optional(true) : std::nullopt;
}

/// The shortest window from sample `first` of a duration and of `min_samples`; empty if the track
/// ends before.
Window window_from(const Track& track, std::size_t first, double duration_s) {
  const auto end = std::lower_bound(
      track.begin() + static_cast<std::ptrdiff_t>(first), track.end(),
      track[first].time_s + (1.0 - 1e-9) * duration_s,
      [](const TrackPoint& point, double time_s) { return point.time_s < time_s; });
  const auto count =
      std::max(static_cast<std::size_t>(end - track.begin()) + 1 - first, min_samples);
  return first + count <= track.size() ? Window(track).subspan(first, count) : Window();
}

double duration_of(Window window) { return window.back().time_s - window.front().time_s; }

/// The longest window from sample `first` that is in flight.
std::optional<Window> flight_from(const Track& track, std::size_t first,
                                  const Eigen::Vector3d& gravity) {
  std::optional<Window> flight;
  for (const double duration_s : window_durations_s) {
    const Window window = window_from(track, first, duration_s);
    if (window.empty() || duration_of(window) > 1.5 * window_durations_s.back()) break;
    const auto in_flight = is_in_flight(window, gravity);
    if (in_flight == false) break;
    if (in_flight == true) flight = window;
  }
  return flight;
}

std::size_t step_at(const Track& track, std::size_t first) {
  const Window window = window_from(track, first, window_durations_s.front());
  return std::max<std::size_t>(1, window.size() / starts_per_window);
}

}  // namespace

std::vector<Flight> find_flights(const Track& track, const Eigen::Vector3d& gravity_m_per_s2) {
  std::vector<Flight> flights;
  for (std::size_t first = 0; first < track.size(); first += step_at(track, first)) {
    const auto window = flight_from(track, first, gravity_m_per_s2);
    if (!window) continue;
    const double release_s = window->front().time_s, landing_s = window->back().time_s;
    if (flights.empty() || release_s > flights.back().landing_s)
      flights.push_back({release_s, landing_s});
    else if (release_s < flights.back().landing_s - max_overlap_s)
      flights.back().landing_s = std::max(flights.back().landing_s, landing_s);
    else {
      const double hit_s = 0.5 * (release_s + flights.back().landing_s);
      flights.back().landing_s = hit_s;
      flights.push_back({hit_s, landing_s});
    }
  }
  return flights;
}

}  // namespace touchtrace
