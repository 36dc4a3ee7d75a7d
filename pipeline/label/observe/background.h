#pragma once

#include <cstdint>
#include <vector>

namespace touchtrace::label {

using DepthImages = std::vector<std::vector<std::uint16_t>>;  ///< [counts]; 0: no measurement

/// Per-pixel median of depth images of the empty scene. 0 where no image has a measurement.
std::vector<std::uint16_t> median_depth(const DepthImages& depths);

/// Per-pixel second largest depth of images in which bodies move in front of a static scene, for a
/// recording without images of the empty scene. 0 (unknown) where over 20 % of the images have no
/// measurement, or if under 25 % of the measurements are within `tolerance` of that depth: a body
/// at varying depths, not a static scene.
std::vector<std::uint16_t> farthest_depth(const DepthImages& depths, double tolerance);

/// Standard deviation [m] of depth noise at 1 m, for noise proportional to depth squared
/// (triangulation). From the pixels' variances over images of a scene of which less than half
/// moves: their median, over that of a chi-square distribution. 0 for fewer than three images.
double depth_noise_at_1m(const DepthImages& depths, double unit_m);

}  // namespace touchtrace::label
