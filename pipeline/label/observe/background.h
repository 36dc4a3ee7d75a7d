#pragma once

#include <cstdint>
#include <optional>
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
/// (triangulation). The median of the variances, over images, of the pixels that may be at rest: no
/// sensor has more than 15 mm. nullopt for fewer than three images, or if less than 5 % of the
/// pixels may be at rest, as where nothing is behind the moving bodies.
std::optional<double> depth_noise_at_1m(const DepthImages& depths, double unit_m);

}  // namespace touchtrace::label
