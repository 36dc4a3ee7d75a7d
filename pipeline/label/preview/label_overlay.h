#pragma once

#include <opencv2/core.hpp>

#include "calib/rgbd/calibration.h"
#include "pipeline/label/states/frame_labels.h"

namespace touchtrace::label {

/// Draws labels into camera frames. Per body, in its colour: the measured centre (dot), the
/// smoothed centre (white cross) with the ellipse of one standard deviation, its path in the last
/// second (line), and the box where a user drew one. A caption below the image has time, clip,
/// object, standard deviations and flags.
class LabelOverlay {
 public:
  /// `recording` and `labels` must outlive the overlay.
  LabelOverlay(const Recording& recording, const RgbdCalibration& calibration,
               const Labels& labels);

  std::size_t num_frames() const { return frames_.size(); }
  double frame_rate_hz() const;  ///< inverse of the median interval
  /// True if a label is near in time.
  bool has_label(std::size_t frame) const { return frames_[frame].label.has_value(); }
  /// True if the label of hand or object has a flag.
  bool is_flagged(std::size_t frame) const;
  /// BGR image with caption. `size_px`: longer side of the camera frame in it.
  cv::Mat draw(std::size_t frame, const RgbdFrame& images, int size_px) const;

 private:
  class Canvas;

  /// Smoothed positions of the last second, newest first.
  std::vector<Eigen::Vector3d> trail(const LabelledBody& body, std::size_t label,
                                     double time_s) const;
  void draw_body(const FrameLabel& frame, double time_s, const LabelledBody& body,
                 const std::vector<double>& raw_m, const cv::Scalar& color, Canvas& canvas) const;
  void draw_caption(const FrameLabel& frame, double time_s, Canvas& canvas) const;

  const Recording& recording_;
  const Labels& labels_;
  Camera camera_;
  std::vector<double> color_time_s_;  ///< [frames] when the colour image was taken
  std::vector<FrameLabel> frames_;
};

}  // namespace touchtrace::label
