#include "calib/smooth/find_flights.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace touchtrace {
namespace {

constexpr std::array window_durations_s{0.15, 0.2, 0.25, 0.3, 0.35, 0.4};
constexpr std::size_t min_samples = 5;
constexpr std::size_t starts_per_window = 16;  // at most: bounds the work for dense samples
constexpr double max_acceleration_sigma_m_per_s2 = 3.0;
constexpr double normal_quantile = 3.0902;     // of 0.999
constexpr double min_likelihood_ratio = 10.8;  // chi-square quantile of 0.999 for one parameter

using Window = std::span<const TrackPoint>;

/// Chi-square quantile of 0.999 (Wilson and Hilferty 1931; error below 1 % from 9 degrees on).
double max_chi_square(double degrees_of_freedom) {
  const double variance = 2.0 / (9.0 * degrees_of_freedom);
  return degrees_of_freedom * std::pow(1.0 - variance + normal_quantile * std::sqrt(variance), 3.0);
}

/// Weighted least squares along one axis of a window.
class AxisFit {
 public:
  AxisFit(Window window, Eigen::Index axis) : window_(window), axis_(axis) {
    for (const auto& point : window_) {
      const Eigen::Vector3d basis = basis_at(point);
      information_ += weight_of(point) * basis * basis.transpose();
    }
  }

  /// Sum of squared residuals over variances at a given acceleration.
  double chi_square(double acceleration) const {
    Eigen::Vector2d sums = Eigen::Vector2d::Zero();
    for (const auto& point : window_)
      sums += weight_of(point) * residual(point, acceleration) * basis_at(point).head<2>();
    const Eigen::Vector2d fit = information_.topLeftCorner<2, 2>().inverse() * sums;
    double result = 0.0;
    for (const auto& point : window_)
      result += weight_of(point) *
                std::pow(residual(point, acceleration) - fit.dot(basis_at(point).head<2>()), 2);
    return result;
  }

  /// Standard error of an acceleration that is estimated.
  double acceleration_sigma() const { return std::sqrt(information_.inverse()(2, 2)); }

 private:
  /// Derivatives of the position by position, velocity and acceleration in the window's centre.
  Eigen::Vector3d basis_at(const TrackPoint& point) const {
    const double t = point.time_s - 0.5 * (window_.front().time_s + window_.back().time_s);
    return {1.0, t, 0.5 * t * t};
  }
  double weight_of(const TrackPoint& point) const {
    return 1.0 / (point.sigma_m[axis_] * point.sigma_m[axis_]);
  }
  double residual(const TrackPoint& point, double acceleration) const {
    return point.position_m[axis_] - window_.front().position_m[axis_] -
           acceleration * basis_at(point)[2];
  }

  Window window_;
  Eigen::Index axis_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
};

/// Whether the window is in flight; nullopt if its acceleration is not known well enough.
std::optional<bool> is_in_flight(Window window, const Eigen::Vector3d& gravity) {
  double falling = 0.0, uniform = 0.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const AxisFit fit(window, axis);
    if (!(fit.acceleration_sigma() < max_acceleration_sigma_m_per_s2)) return std::nullopt;
    falling += fit.chi_square(gravity[axis]);
    uniform += fit.chi_square(0.0);
  }
  const double degrees_of_freedom = 3.0 * static_cast<double>(window.size()) - 6.0;
  return falling < max_chi_square(degrees_of_freedom) && uniform - falling > min_likelihood_ratio;
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

/// The window from sample `first` that tells whether the body is in flight, if it is.
std::optional<Window> flight_from(const Track& track, std::size_t first,
                                  const Eigen::Vector3d& gravity) {
  for (const double duration_s : window_durations_s) {
    const Window window = window_from(track, first, duration_s);
    if (window.empty() || duration_of(window) > 1.5 * window_durations_s.back()) return {};
    if (const auto in_flight = is_in_flight(window, gravity))
      return *in_flight ? std::optional(window) : std::nullopt;
  }
  return std::nullopt;
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
    if (!flights.empty() && release_s <= flights.back().landing_s)
      flights.back().landing_s = std::max(flights.back().landing_s, landing_s);
    else
      flights.push_back({release_s, landing_s});
  }
  return flights;
}

}  // namespace touchtrace
