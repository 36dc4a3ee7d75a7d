#pragma once

#include <optional>

#include "pipeline/label/body_fit.h"

namespace touchtrace::label {

/// The pose of one rigid body from frame to frame: each is sought near the last rotation and near
/// where it turned on to. Where that fits worse than usual, every few frames, and after a while
/// unseen, rotations all around are tried as well.
class PoseTracker {
 public:
  explicit PoseTracker(const RoundedBox& box) : box_(box) {}

  /// `seconds` since the last view that was given.
  BodyFit see(const BodyView& view, double seconds);

 private:
  BodyFit seek(const BodyView& view, double seconds);
  BodyFit follow(const BodyView& view, double seconds) const;

  RoundedBox box_;
  std::optional<Eigen::Quaterniond> rotation_;
  Eigen::Vector3d turn_rad_per_s_ = Eigen::Vector3d::Zero();
  double usual_cost_m2_ = 0.0;  ///< of a point
  int followed_ = 0;            ///< frames since all rotations were tried
};

}  // namespace touchtrace::label
