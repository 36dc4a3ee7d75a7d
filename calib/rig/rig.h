#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Calibrated cameras that are fixed to each other. The rig's frame is that of the first camera.
///
/// `covariance` is that of the estimated parameters, with board poses and deformation marginalised
/// out. Their names: NAME.fx .. NAME.cy [px] and estimated lens coefficients of each camera;
/// NAME_from_FIRST.rx .. rz [rad] (R = exp(r) R_estimate), NAME_from_FIRST.tx .. tz [m] of each
/// camera but the first; board.warp_x, board.warp_y [m].
struct RigCalibration {
  std::vector<std::string> names;        ///< of the cameras
  std::vector<RgbdCalibration> cameras;  ///< with the intrinsics of the joint fit
  std::vector<Eigen::Isometry3d> camera_from_rig;
  std::vector<std::string> parameters;  ///< names, in the order of the covariance
  Eigen::MatrixXd covariance;
  nlohmann::json details;  ///< rig_details(), provenance
};

inline constexpr const char* rig_schema = "touchtrace/rig/1";

/// Pose of a camera in the rig, as people measure it.
struct RelativePose {
  double baseline_m, baseline_sigma_m;      ///< distance to the first camera
  double rotation_rad, rotation_sigma_rad;  ///< angle to the first camera
};

/// `camera`: index, at least 1. NaN for standard deviations if the covariance is empty.
RelativePose relative_pose(const RigCalibration& rig, std::size_t camera);

/// Covariance of NAME_from_FIRST, rotation first; NaN if it was not estimated.
Eigen::Matrix<double, 6, 6> pose_covariance(const RigCalibration& rig, std::size_t camera);

/// Content of rig.json.
nlohmann::json rig_json(const RigCalibration& rig);

/// Writes into `folder`: rig.json, camchain.yaml (kalibr), FIRST_NAME_opencv.yaml for each camera
/// but the first (cv::FileStorage with M1, D1, M2, D2, R, T of cv::stereoCalibrate), and a folder
/// of write_calibration() for each camera. Throws if a file exists, unless `overwrite`; then
/// nothing is written.
void write_rig(const std::filesystem::path& folder, const RigCalibration& rig, bool overwrite);

/// Reads a folder or rig.json of write_rig(), or a camchain of any number of cameras, which are
/// named cam0, cam1, .. and have no covariance. Details of the cameras are not read. Throws
/// data_error for an invalid file.
RigCalibration read_rig(const std::filesystem::path& folder_or_file);

}  // namespace touchtrace
