#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/image_grid.h"

namespace touchtrace {

/// Calibrated RGB-D camera. True depth [m] = depth_offset_m + depth_scale * measured depth [m].
///
/// `covariance` is that of the estimated parameters, with board poses and deformation marginalised
/// out. Their names: color.fx .. color.cy [px] and the estimated lens coefficients; board.warp_x,
/// board.warp_y [m]; depth_from_color.rx .. rz [rad] (R = exp(r) R_estimate),
/// depth_from_color.tx .. tz [m]; depth.fx .. depth.cy [px]; depth.scale; depth.offset [m];
/// depth.delay [s].
struct RgbdCalibration {
  Camera color;
  std::optional<Camera> depth;  ///< nullopt: colour only
  Eigen::Isometry3d depth_from_color = Eigen::Isometry3d::Identity();
  double depth_scale = 1.0, depth_offset_m = 0.0;
  double depth_delay_s = 0.0;            ///< exposure of a depth image minus its time stamp
  std::array<double, 2> board_warp_m{};  ///< coefficients of CalibrationTarget::warp_basis
  ImageGrid::Mask lit = ImageGrid::Mask::Constant(true);  ///< BoardObservations::lit; not in files

  double rms_px = 0.0;                  ///< RMS length of the corner residuals
  double depth_rms_m = 0.0;             ///< RMS of the depth residuals
  std::vector<std::string> parameters;  ///< names, in the order of the covariance
  Eigen::MatrixXd covariance;           ///< covariance_of_estimate()
  nlohmann::json details;               ///< calibration_details(), provenance
};

inline constexpr const char* calibration_schema = "touchtrace/calibration/2";

/// Content of calibration.json.
nlohmann::json calibration_json(const RgbdCalibration& calibration);
/// Inverse of calibration_json(); also reads the older names of keys in `details`. Throws
/// std::exception for an invalid document.
RgbdCalibration calibration_from_json(const nlohmann::json& document);

/// Writes calibration.json into `folder` and, for other programs, camera.yaml (ROS camera_info),
/// camera_opencv.yaml (cv::FileStorage), the same two of the depth camera as camera_depth.yaml and
/// camera_depth_opencv.yaml, and camchain.yaml (kalibr). Throws if a file exists, unless
/// `overwrite`; then nothing is written.
void write_calibration(const std::filesystem::path& folder, const RgbdCalibration& calibration,
                       bool overwrite);
/// Reads a folder or calibration.json of write_calibration(), or a YAML or JSON file of another
/// program (foreign_calibration.h). Throws data_error for an invalid file.
RgbdCalibration read_calibration(const std::filesystem::path& folder_or_file);

}  // namespace touchtrace
