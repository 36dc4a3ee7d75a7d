#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// How the labels of one body err: the figures of BodyError.
struct BodyErrorModel {
  std::array<double, 3> position_m;                  ///< deviations
  double velocity_m_per_s, causal_velocity_m_per_s;  ///< per axis, less what the delay explains
};

/// How the vision pipeline errs, for data sets that are too many to be rendered. Its errors are
/// smooth: band-limited noise of that deviation in place has that one in speed if its band ends at
/// sqrt(3) velocity / (2 pi position). Filtered states err more in speed, from frame to frame.
struct LabelErrorModel {
  BodyErrorModel object, hand;
  double delay_s;     ///< of the labels
  double lost_share;  ///< of the labels, not to be trusted
};

/// As `touchtrace-verify labels` measured it of the activity's own object at 640x480 over three
/// seeds. What leaves the picture is lost, too. Throws usage_error for an activity without.
const LabelErrorModel& measured_label_error(const std::string& activity);

/// A simulated recording with labels that err like that instead of those of its images. Times are
/// those that its stamps give. The truth is attached and shifted like that of a session.
Dataset load_with_modelled_labels(const std::filesystem::path& recording,
                                  const LabelErrorModel& model, int resolution, std::uint64_t seed);

/// A simulated recording with images, calibrated and labelled like a user's, with the fast tracker;
/// truth as above. Throws data_error where that would be refused to a user.
Dataset load_with_rendered_labels(const std::filesystem::path& recording, int resolution);

}  // namespace touchtrace::study
