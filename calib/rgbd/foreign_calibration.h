#pragma once

#include <filesystem>
#include <string>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// kalibr camchain: cam0 is the colour, cam1 the depth camera, T_cn_cnm1 = depth_from_color. kalibr
/// knows radtan with four coefficients and equidistant. For a lens with k3 != 0 and a rational
/// lens, four coefficients are fitted to the distortion over the image; a comment in the file
/// states their largest error [px].
std::string camchain_yaml(const RgbdCalibration& calibration);

/// cv::FileStorage with the keys of OpenCV's calibration sample.
std::string file_storage_yaml(const Camera& camera);

/// Reads a ROS camera_info, a cv::FileStorage or a kalibr camchain. The first two describe one
/// camera with registered depth; cam1 of a camchain is the depth camera. The lens is the simplest
/// one that has all nonzero coefficients. Depth is not corrected; the covariance is empty. Throws
/// data_error for an invalid file or an unsupported lens, such as thin prism.
RgbdCalibration read_foreign_calibration(const std::filesystem::path& file);

}  // namespace touchtrace
