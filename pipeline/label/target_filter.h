#pragma once

#include <array>

#include "calib/smooth/kalman_state.h"

namespace touchtrace::label {

/// Where a target is expected: constant velocity with white acceleration, or falling under gravity.
class TargetFilter {
 public:
  void start(const Eigen::Vector3d& position_m, double sigma_m);
  void predict(double seconds, bool falling, const Eigen::Vector3d& gravity_m_per_s2);
  void measure(const Eigen::Vector3d& position_m, double sigma_m);

  Eigen::Vector3d position_m() const;
  /// Radius around the prediction in which the target must be.
  double gate_m() const;

 private:
  std::array<AxisState<double>, 3> axes_;
};

}  // namespace touchtrace::label
