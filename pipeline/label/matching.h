#pragma once

#include "calib/rgbd/calibration.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Throws data_error unless the calibration's image sizes are those of the recording.
void require_matching(const RgbdCalibration& calibration, const CameraInfo& camera);

}  // namespace touchtrace::label
