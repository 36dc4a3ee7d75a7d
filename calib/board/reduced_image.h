#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Image reduced by an integer factor.
struct ReducedImage {
  GreyImage image;
  int factor;

  /// Reduces the larger side to at most 1280 pixels.
  explicit ReducedImage(const GreyImage& original);
};

/// Refines corners that were found in the reduced image by refine_saddle_point() in the original.
/// Returns false if one has no saddle there.
bool refine_in_original(std::vector<Eigen::Vector2d>& corners, const ReducedImage& reduced,
                        const GreyImage& original);

}  // namespace touchtrace
