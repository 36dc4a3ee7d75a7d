#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/labels.h"

namespace touchtrace {

/// Warnings of implausible labels: positions far from the camera, jumps, covariances
/// that are not symmetric or have negative variances, unknown bits of quality, velocities that are
/// not the derivative of the positions, causal states that equal the smoothed ones, times outside
/// their clips.
std::vector<std::string> label_warnings(const Labels& labels);

}  // namespace touchtrace
