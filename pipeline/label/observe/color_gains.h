#pragma once

#include <array>

#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Factor of each channel by which an image is brighter than a reference image of the same static
/// camera, from auto exposure and auto white balance.
using ColorGains = std::array<double, 3>;

/// Median over a grid of pixels of the ratio of both images; 1 for a channel that has too few
/// pixels between black and saturation. Less than half of the picture may move.
ColorGains color_gains(const RgbdFrame& reference, const RgbdFrame& frame);

/// Divides an image by its gains, unless all are within 1 % of one.
void normalize_colors(const ColorGains& gains, RgbdFrame& frame);

}  // namespace touchtrace::label
