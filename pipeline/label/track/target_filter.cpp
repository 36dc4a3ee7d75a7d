#include "pipeline/label/track/target_filter.h"

#include <cmath>

namespace touchtrace::label {
namespace {

// Spectral densities of the acceleration [m^2/s^3]. Hand: 15 m/s^2 for 0.1 s. Flight: spin, drag
// and the camera's tilt error.
constexpr double hand_density = 22.0, falling_density = 1.0;
constexpr double start_speed_m_per_s = 1.0, min_gate_m = 0.05;

/// Transition of position and velocity over `h` seconds.
Transition<2> constant_velocity(double h, double density, bool falling) {
  Transition<2> step;
  step.F << 1.0, h, 0.0, 1.0;
  step.Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
  step.Q *= density;
  if (falling) step.u << h * h / 2.0, h;
  return step;
}

}  // namespace

void TargetFilter::start(const Eigen::Vector3d& position_m, double sigma_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes_[axis].mean << position_m[static_cast<Eigen::Index>(axis)], 0.0;
    axes_[axis].covariance.setZero();
    axes_[axis].covariance.diagonal() << sigma_m * sigma_m,
        start_speed_m_per_s * start_speed_m_per_s;
  }
}

void TargetFilter::predict(double seconds, bool falling, const Eigen::Vector3d& gravity_m_per_s2) {
  const auto step = constant_velocity(seconds, falling ? falling_density : hand_density, falling);
  for (std::size_t axis = 0; axis < 3; ++axis)
    axes_[axis] = axes_[axis].predict(step, gravity_m_per_s2[static_cast<Eigen::Index>(axis)], 1.0);
}

void TargetFilter::measure(const Eigen::Vector3d& position_m, double sigma_m) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    axes_[axis].update(position_m[static_cast<Eigen::Index>(axis)], sigma_m * sigma_m);
}

Eigen::Vector3d TargetFilter::position_m() const {
  return {axes_[0].mean[0], axes_[1].mean[0], axes_[2].mean[0]};
}

double TargetFilter::gate_m() const {
  const double largest =
      std::max({axes_[0].covariance(0, 0), axes_[1].covariance(0, 0), axes_[2].covariance(0, 0)});
  return min_gate_m + gate_sigmas * std::sqrt(largest);
}

}  // namespace touchtrace::label
