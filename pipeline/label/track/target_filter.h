#pragma once

#include <array>

#include "calib/smooth/kalman_state.h"

namespace touchtrace::label {

/// Standard deviations in a gate.
inline constexpr double gate_sigmas = 4.0;

/// Kalman filter of a target's position and velocity: white acceleration noise, or free fall under
/// gravity.
class TargetFilter {
 public:
  void start(const Eigen::Vector3d& position_m, double sigma_m);
  void predict(double seconds, bool falling, const Eigen::Vector3d& gravity_m_per_s2);
  void measure(const Eigen::Vector3d& position_m, double sigma_m);

  Eigen::Vector3d position_m() const;
  /// Radius of the gate around the predicted position: 0.05 m plus four standard deviations.
  double gate_m() const;

 private:
  std::array<AxisState<2>, 3> axes_;
};

}  // namespace touchtrace::label
