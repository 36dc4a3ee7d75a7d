#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"

namespace touchtrace {

/// A calibrated RGBD camera. True depth [m] = depth_offset_m + depth_scale * measured depth [m].
///
/// The covariance is of the free parameters alone, the board's poses and print marginalised out.
/// Names: color.fx .. color.cy [px] and the lens's free coefficients, board.warp_x, board.warp_y
/// [m], depth_from_color.rx .. rz [rad] (R = exp(r) R_estimated), depth_from_color.tx .. tz [m],
/// depth.fx .. depth.cy [px], depth.scale, depth.offset [m], depth.delay [s].
struct RgbdCalibration {
  Camera color;
  std::optional<Camera> depth;  ///< absent for a colour-only calibration
  Eigen::Isometry3d depth_from_color = Eigen::Isometry3d::Identity();
  double depth_scale = 1.0, depth_offset_m = 0.0;
  double depth_delay_s = 0.0;  ///< depth images show what is this much later than they are stamped
  std::array<double, 2> board_warp_m{};  ///< of Chessboard::warp_shape

  double rms_px = 0.0;                  ///< of the colour corners
  double depth_rms_m = 0.0;             ///< of the depth residuals
  std::vector<std::string> parameters;  ///< names, in the order of the covariance
  Eigen::MatrixXd covariance;           ///< of `parameters` (covariance_of_estimate)
  nlohmann::json details;  ///< per-view residuals and RMS, outliers, verdict, provenance
};

inline constexpr const char* calibration_schema = "touchtrace/calibration/2";

/// calibration.json as it is written.
nlohmann::json calibration_json(const RgbdCalibration& calibration);
/// The same read back. Throws std::exception on a fault.
RgbdCalibration calibration_from_json(const nlohmann::json& document);

/// Writes calibration.json with everything into `folder`, and for other programs camera.yaml (ROS
/// camera_info), camera_opencv.yaml (cv::FileStorage), both with camera_depth beside them, and
/// camchain.yaml (kalibr). Refuses files that exist unless `overwrite`.
void write_calibration(const std::filesystem::path& folder, const RgbdCalibration& calibration,
                       bool overwrite);
/// Reads what write_calibration wrote, or a YAML file of another program
/// (foreign_calibration.h). Throws data_error on a fault.
RgbdCalibration read_calibration(const std::filesystem::path& folder_or_file);

}  // namespace touchtrace
