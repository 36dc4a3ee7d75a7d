#pragma once

#include <filesystem>
#include <string>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// As a kalibr camchain: cam0 the colour, cam1 the depth camera, T_cn_cnm1 between them. It has
/// radtan with four coefficients and equidistant: where k3 is not 0, or of a rational lens, four
/// coefficients are fitted to make up for it in the image, and a comment says by how many pixels
/// that fails.
std::string camchain_yaml(const RgbdCalibration& calibration);

/// As a cv::FileStorage with the keys of OpenCV's own calibration program.
std::string file_storage_yaml(const Camera& camera);

/// A ROS camera_info, a cv::FileStorage or a kalibr camchain, whichever the YAML file holds. The
/// first two are one camera, to which depth is registered; cam1 of a camchain is the depth camera.
/// Depth is taken as it is measured, and no covariance is known. The
/// lens is the simplest that has the coefficients which are not 0. Throws data_error for a fault,
/// or a lens that is not one of all_lenses(), such as thin prisms.
RgbdCalibration read_foreign_calibration(const std::filesystem::path& file);

}  // namespace touchtrace
