#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {

/// Displacement of what moves in depth images from what moves in colour images.
struct MotionShift {
  cv::Point2d depth_from_color_px;  ///< in pixels of the colour image
  /// Normalised cross-correlation of both images of motion, at this shift and without a shift.
  double correlation = 0.0, unshifted_correlation = 0.0;

  /// Whether the depth images can be on the colour camera's pixels: the shift is under 1.5 % of
  /// the image's width, or hardly better than none. Shadows of the projector and delays between
  /// both streams shift the correlation of registered images by less.
  bool is_consistent_with_registration(int width) const;
};

/// Compares what moves between a dozen pairs of images spread over two streams of equal image size
/// from a static camera. nullopt: too little moves, the camera does,
/// or there are fewer than eight pairs.
std::optional<MotionShift> measure_motion_shift(const SourceStream& color,
                                                const SourceStream& depth);

/// Time by which stamps of depth images are later than those of colour images that show the same
/// motion.
struct DepthDelay {
  double seconds, images;  ///< images: over the longer interval of both streams
};

/// Delay of depth in streams of registered images from a static camera: that at which successive
/// images show motion at the same pixels. Looks at 16 places and delays of up to six images.
/// nullopt: too little moves, or no delay stands out.
std::optional<DepthDelay> measure_depth_delay(const SourceStream& color, const SourceStream& depth);

}  // namespace touchtrace
