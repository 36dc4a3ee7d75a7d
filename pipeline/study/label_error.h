#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// How far the labels of one body are from the truth, in the colour camera's frame. Labels further
/// off than 60 mm (from the truth plus the median offset) are wrong; errors are of all that are
/// neither lost nor wrong. What no recording shows (where a body's middle is, the streams' least
/// latency) is given as bias and delay; spread and aligned velocity are of what is left. Coverage
/// and NEES have the bias in them, as covariances have; of the hand, whose bias is from blob to
/// palm, they mean nothing. Velocities, coverage and NEES leave out where an impact lies between
/// the truth's samples: its velocity there is not known.
struct BodyError {
  double lost_share = 0.0;     ///< labels that say so, of a body in the picture
  double outside_share = 0.0;  ///< of labels while the body's middle was outside the picture
  double follows_share = 0.0;  ///< labels that say that they follow the hand
  double impact_share = 0.0;   ///< of labels with an impact between the truth's samples around it
  double wrong_share = 0.0;    ///< of labels that do not say that they are lost
  double wrong_unsaid_share = 0.0;                   ///< wrong while said to be good
  Eigen::Vector3d bias_m = Eigen::Vector3d::Zero();  ///< mean error; of the hand: from blob to palm
  Eigen::Vector3d position_rms_m = Eigen::Vector3d::Zero();     ///< bias and delay included
  Eigen::Vector3d position_spread_m = Eigen::Vector3d::Zero();  ///< both removed
  double velocity_rms_m_per_s = 0.0;                            ///< per axis, all three
  double causal_velocity_rms_m_per_s = 0.0;                     ///< of the filtered states
  double delay_s = 0.0;  ///< at which the labels lie nearest to the truth: latency no stamp shows
  double aligned_velocity_rms_m_per_s = 0.0;  ///< with that delay removed
  double position_coverage = 0.0;             ///< share of axes within the 80 % interval
  double velocity_coverage = 0.0;
  double nees = 0.0;  ///< mean squared error in units of the covariance, 1 if it is true
};

struct LabelError {
  BodyError hand, object;
};

/// Truth is interpolated to the labels' times. Labels outside the truth's clips are left out.
/// Throws data_error if nothing is left.
LabelError compare_labels_with_truth(const Labels& labels, const Truth& truth);

void to_json(nlohmann::json& json, const BodyError& error);
void to_json(nlohmann::json& json, const LabelError& error);

}  // namespace touchtrace::study
