#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calib/board/calibration_target.h"

namespace touchtrace {

/// Homography from places on the target to the image [px] near a place. Lens distortion hardly
/// bends it there.
class LocalHomography {
 public:
  static constexpr double reach = 3.2;  ///< [square_m] a little more than three rows

  /// Least-squares fit; nullopt if the points do not determine it.
  static std::optional<LocalHomography> fit(const std::vector<cv::Point2d>& places,
                                            const std::vector<cv::Point2d>& pixels);

  /// Least-squares fit to the corners within three rows or columns of `place_m`; nullopt unless
  /// six or more are known there, in two rows and two columns.
  static std::optional<LocalHomography> fit(const TargetCorners& corners,
                                            const CalibrationTarget& target,
                                            const Eigen::Vector2d& place_m);

  Eigen::Vector2d image_of(const Eigen::Vector2d& place_m) const;
  /// Place on the target whose image is `pixel`.
  Eigen::Vector2d place_of(const Eigen::Vector2d& pixel) const;
  /// Derivative of image_of() [px/m].
  Eigen::Matrix2d derivative(const Eigen::Vector2d& place_m) const;

 private:
  explicit LocalHomography(const cv::Matx33d& h) : h_(h), inverse_(h.inv()) {}
  cv::Matx33d h_, inverse_;
};

}  // namespace touchtrace
