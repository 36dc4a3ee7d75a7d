#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// Errors of one body's labels relative to the truth, in the colour camera's frame.
///
/// - A label is wrong if it is over 60 mm from the truth shifted by the median offset.
/// - RMS, bias and spread are over labels neither lost nor wrong.
/// - `position_spread_m` and `aligned_velocity_rms_m_per_s` are without bias and delay, which no
///   recording shows: the position of a body's centre and the streams' minimum latency.
/// - Coverage and NEES are without alignment, over all labels not flagged as lost. The hand's say
///   nothing, since its label is the centre of its visible part.
/// - Velocities, coverage and NEES exclude times with an impact between the truth's samples, where
///   the true velocity is unknown.
struct BodyError {
  double lost_share = 0.0;          ///< marked as lost while the body is in the image
  double outside_share = 0.0;       ///< the body's centre is outside the image
  double follows_share = 0.0;       ///< marked as following the hand
  double impact_share = 0.0;        ///< impact between the truth's samples around it
  double wrong_share = 0.0;         ///< wrong and not marked as lost
  double wrong_unsaid_share = 0.0;  ///< wrong and marked as good
  Eigen::Vector3d bias_m = Eigen::Vector3d::Zero();             ///< mean error
  Eigen::Vector3d position_rms_m = Eigen::Vector3d::Zero();     ///< bias and delay included
  Eigen::Vector3d position_spread_m = Eigen::Vector3d::Zero();  ///< both removed
  double velocity_rms_m_per_s = 0.0;                            ///< per axis, all three
  double causal_velocity_rms_m_per_s = 0.0;                     ///< of the causal states
  double delay_s = 0.0;  ///< of the labels, minimising the distance to the truth: latency that
                         ///< stamps do not show
  double aligned_velocity_rms_m_per_s = 0.0;  ///< with that delay removed
  // Of all labels not flagged as lost, without alignment: bias, delay and wrong positions included.
  double position_coverage = 0.0;  ///< fraction of axes inside the 80 % interval
  double velocity_coverage = 0.0;
  double nees = 0.0;  ///< normalised estimation error squared per dimension; 1 if calibrated
};

struct LabelError {
  BodyError hand, object;
};

/// Compares labels with the truth interpolated to their times, without labels outside the truth's
/// clips. Throws data_error if none remains.
LabelError compare_labels_with_truth(const Labels& labels, const Truth& truth);

void to_json(nlohmann::json& json, const BodyError& error);
void to_json(nlohmann::json& json, const LabelError& error);

}  // namespace touchtrace::study
