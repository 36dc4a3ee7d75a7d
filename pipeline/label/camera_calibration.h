#pragma once

#include "calib/rgbd/calibration.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Standard deviations assumed for a calibration without covariance, between the specifications of
/// Azure Kinect (depth: 11 mm + 0.1 %) and RealSense D400 (depth: 2 % at 2 m, 80 % of the image).
inline constexpr double default_focal_sigma = 0.005,  // relative, also of the depth scale
    default_centre_sigma = 0.003;                     // of the principal point, image widths

/// Calibration for labelling a recording: `given`, with what it lacks from the camera's driver
/// (nullopt: all), and with the default covariance if it has none. Throws data_error if the image
/// sizes differ from the recording's, or if neither knows a camera.
RgbdCalibration camera_calibration(const std::optional<RgbdCalibration>& given,
                                   const CameraInfo& camera);

}  // namespace touchtrace::label
