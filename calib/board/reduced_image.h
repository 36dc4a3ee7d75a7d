#pragma once

#include <optional>

#include "calib/board/board_view.h"

namespace touchtrace {

/// Image reduced by an integer factor.
struct ReducedImage {
  GreyImage image;
  int factor;

  /// Reduces the larger side to at most 1280 pixels.
  explicit ReducedImage(const GreyImage& original);
};

/// Moves corners from the reduced image to the original.
std::vector<Eigen::Vector2d> to_original(std::vector<Eigen::Vector2d> corners,
                                         const ReducedImage& reduced);

/// Refines corners by refine_saddle_point() in the original of an image that was reduced by
/// `factor`. [corners] nullopt: no saddle there.
std::vector<std::optional<Eigen::Vector2d>> refined_corners(
    const std::vector<Eigen::Vector2d>& corners, int factor, const GreyImage& original);

}  // namespace touchtrace
