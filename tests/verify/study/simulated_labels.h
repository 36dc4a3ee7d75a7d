#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Label errors of one body, as BodyError measures them.
struct BodyErrorModel {
  std::array<double, 3> position_m;                  ///< standard deviations
  double velocity_m_per_s, causal_velocity_m_per_s;  ///< per axis, without the delay's part
};

/// Model of the vision pipeline's label errors, for data sets too large to render. Errors are
/// smooth: band-limited noise with the given standard deviations of position and velocity, whose
/// band ends at sqrt(3) velocity / (2 pi position). Causal velocities have additional white errors.
struct LabelErrorModel {
  BodyErrorModel object, hand;
  double delay_s;     ///< of the labels
  double lost_share;  ///< untrusted fraction of the labels
};

/// Errors that `touchtrace-verify labels` measured with the activity's default object at 640x480,
/// three seeds. Objects outside the image count as lost. Throws usage_error for other activities.
const LabelErrorModel& measured_label_error(const std::string& activity);

/// Loads a simulated recording with modelled labels instead of those of its images. Label times
/// follow from its stamps. The truth is attached and shifted as in load_sessions.
Dataset load_with_modelled_labels(const std::filesystem::path& recording,
                                  const LabelErrorModel& model, int resolution, std::uint64_t seed);

/// Loads a simulated recording with images, calibrated and labelled with the tracker "component";
/// truth as above. Throws data_error if calibration or labelling fail.
Dataset load_with_rendered_labels(const std::filesystem::path& recording, int resolution);

}  // namespace touchtrace::study
