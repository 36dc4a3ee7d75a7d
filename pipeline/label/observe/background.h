#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace touchtrace::label {

using DepthImages =
    std::vector<std::vector<std::uint16_t>>;  ///< [images][pixels] counts; 0: no measurement

/// Per-pixel median of depth images of the empty scene. 0 where no image has a measurement.
std::vector<std::uint16_t> median_depth(const DepthImages& depths);

/// Per-pixel second largest depth of images in which bodies move in front of a static scene, for a
/// recording without images of the empty scene. 0 (unknown) where over 20 % of the images have no
/// measurement, or if under 25 % of the measurements are within `tolerance_counts` of that depth: a
/// body at varying depths, not a static scene.
std::vector<std::uint16_t> farthest_depth(const DepthImages& depths, double tolerance_counts);

/// Standard deviation [m] of the depth noise at 1 m, for noise proportional to depth squared
/// (triangulation): median over pixels of the variance over images. Pixels above 15 mm are taken
/// for moving and excluded. nullopt for fewer than three images, or if under 5 % of the pixels
/// remain.
std::optional<double> depth_noise_at_1m(const DepthImages& depths, double unit_m);

}  // namespace touchtrace::label
