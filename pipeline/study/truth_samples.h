#pragma once

#include <Eigen/Core>
#include <optional>

#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// Time between two samples of the truth.
struct TruthInterval {
  std::size_t index;  ///< of the earlier sample
  double fraction;    ///< of the interval, 0..1
};

/// Returns nullopt outside the clip's samples.
std::optional<TruthInterval> find_interval(const Truth& truth, std::int32_t clip, double time_s);

/// Row of an array [n, 3].
Eigen::Vector3d row(const std::vector<double>& values, std::size_t index);
Eigen::Vector3d interpolate(const std::vector<double>& values, const TruthInterval& interval);

/// Magnitude [m/s^2] from the velocities at both ends of the interval.
double acceleration(const Truth& truth, const Truth::Body& body, const TruthInterval& interval);

/// Whether the simulated camera's image contains a position; true if the truth has no camera.
bool in_image(const Truth& truth, const Eigen::Vector3d& position_m);

}  // namespace touchtrace::study
