#pragma once

#include <Eigen/Core>
#include <optional>

#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// A time between two of the truth's samples: index of the earlier one and the part of the way to
/// the later one.
struct TruthPlace {
  std::size_t index;
  double part;
};

/// Nothing outside of the clip's samples.
std::optional<TruthPlace> find_place(const Truth& truth, std::int32_t clip, double time_s);

/// Of numbers in rows of three.
Eigen::Vector3d row(const std::vector<double>& values, std::size_t index);
Eigen::Vector3d interpolate(const std::vector<double>& values, const TruthPlace& place);

/// By the velocities of the samples on both sides, in m/s^2.
double acceleration(const Truth& truth, const Truth::Body& body, const TruthPlace& place);

/// Whether the simulated camera looks at a place; a truth without a camera sees everything.
bool in_picture(const Truth& truth, const Eigen::Vector3d& position_m);

}  // namespace touchtrace::study
