#pragma once

#include <optional>
#include <vector>

#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {

/// Positive finite values of up to nine images, in the source's unit. nullopt: no image can be
/// read.
std::optional<std::vector<double>> sample_depth_values(const SourceStream& depth);

/// Value that many pixels have exactly, and that may mark missing depth.
struct DepthCode {
  double value = 0.0;
  double share = 0.0;  ///< of the values
};

/// Finds the value that over 10 % of the pixels have exactly, if less than 1 % of the others exceed
/// half of it. Whether it marks missing depth only its distance in metres can tell: a wall in a
/// simulated image has one value, too.
std::optional<DepthCode> find_depth_code(std::vector<double> values);

}  // namespace touchtrace
