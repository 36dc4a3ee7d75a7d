#pragma once

#include <filesystem>
#include <string>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Entry of a kalibr camchain.
struct ChainCamera {
  std::string topic;  ///< rostopic
  Camera camera;
  Eigen::Isometry3d from_previous = Eigen::Isometry3d::Identity();  ///< T_cn_cnm1, not of cam0
};

/// kalibr camchain. kalibr knows radtan with four coefficients and equidistant. For a lens with
/// k3 != 0 and a rational lens, four coefficients are fitted to the distortion over the image; a
/// comment in the file states their largest error [px].
std::string camchain_yaml(const std::vector<ChainCamera>& chain);
/// The same for cam0, the colour, and cam1, the depth camera.
std::string camchain_yaml(const RgbdCalibration& calibration);
/// Reads all cameras of a camchain: cam0, cam1, .. Throws data_error for an invalid file.
std::vector<ChainCamera> read_camchain(const std::filesystem::path& file);

/// cv::FileStorage with the keys of OpenCV's calibration sample.
std::string file_storage_yaml(const Camera& camera);

/// Content of a YAML or JSON text, also of a cv::FileStorage. Throws std::exception if it is
/// invalid, too large or nested too deeply.
nlohmann::json parse_yaml(std::string text);

/// Camera of a sensor_msgs/CameraInfo message, by its fields' names. Throws std::exception if it is
/// invalid or has an unsupported lens.
Camera camera_from_info(const nlohmann::json& message);

/// Reads a ROS camera_info, as file or as `rostopic echo` and `ros2 topic echo` print it (the first
/// document), a cv::FileStorage or a kalibr camchain. All but the last describe one camera with
/// registered depth; cam1 of a camchain is the depth camera. The lens is the simplest
/// one that has all nonzero coefficients. Depth is not corrected; the covariance is empty. Throws
/// data_error for an invalid file or an unsupported lens, such as thin prism.
RgbdCalibration read_foreign_calibration(const std::filesystem::path& file);

}  // namespace touchtrace
