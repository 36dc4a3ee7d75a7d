#pragma once

#include <span>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Steps over which roll-outs are evaluated: L1@50 and L1@20 (Table II).
inline constexpr int horizon_steps = 50, short_horizon_steps = 20;

/// [steps, 12] States of one roll-out at steps 1, 2, ...; finite, normalised unless in metres.
/// Compared paths have the same length.
using Path = std::span<const float>;

/// [steps] |predicted - target|, mean over the 12 dimensions.
std::vector<double> l1_by_step(Path predicted, Path target);

/// Dimensions `first` .. `first` + `count` - 1 of a state.
struct Dimensions {
  int first = 0, count = state_size;
};
inline constexpr Dimensions object_position{0, 3}, object_velocity{3, 3}, hand_position{6, 3},
    hand_velocity{9, 3};

/// Hausdorff distance of two paths as sets of states (section III-D), with the Euclidean distance
/// over `dimensions`. NaN if a path is empty.
double hausdorff(Path a, Path b, Dimensions dimensions = {});

/// [steps] Euclidean distance over `dimensions`; of unscaled states in m or m/s.
std::vector<double> distance_by_step(Path predicted, Path target, Dimensions dimensions);

/// States of the steps with a positive weight.
std::vector<float> weighted_steps(Path path, std::span<const float> weight);

/// Weighted mean of the first `steps` values; NaN if all their weights are 0.
double mean_until(std::span<const double> by_step, std::span<const float> weight, int steps);

}  // namespace touchtrace::study
