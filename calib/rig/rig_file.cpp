#include <fmt/core.h>

#include <opencv2/core.hpp>

#include "calib/rgbd/calibration_json.h"
#include "calib/rgbd/foreign_calibration.h"
#include "calib/rig/rig.h"
#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr std::uintmax_t max_bytes = 64u << 20;

std::string camchain(const RigCalibration& rig) {
  std::vector<ChainCamera> chain;
  Eigen::Isometry3d previous = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    chain.push_back({"/" + rig.names[i] + "/image_raw", rig.cameras[i].color,
                     rig.camera_from_rig[i] * previous.inverse()});
    previous = rig.camera_from_rig[i];
  }
  return camchain_yaml(chain);
}

cv::Mat matrix_of(const Eigen::MatrixXd& matrix) {
  cv::Mat result(static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols()), CV_64F);
  for (int i = 0; i < result.rows; ++i)
    for (int j = 0; j < result.cols; ++j) result.at<double>(i, j) = matrix(i, j);
  return result;
}

/// Keys of OpenCV's stereo_calib sample.
std::string stereo_yaml(const Camera& first, const Camera& second,
                        const Eigen::Isometry3d& second_from_first) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const auto add = [&](const std::string& number, const Camera& c) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    matrix(0, 0) = c.fx, matrix(0, 2) = c.cx, matrix(1, 1) = c.fy, matrix(1, 2) = c.cy;
    storage << "M" + number << matrix_of(matrix);
    const int count = lens_interop(c.lens).num_ros_coefficients;
    storage << "D" + number << matrix_of(c.distortion.head(count).transpose());
    storage << "size" + number << std::vector<int>{c.width, c.height};
    storage << "fisheye_model" + number << int(!is_perspective(c.lens));
  };
  add("1", first), add("2", second);
  storage << "R" << matrix_of(second_from_first.linear());
  storage << "T" << matrix_of(second_from_first.translation());
  return storage.releaseAndGetString();
}

/// Cameras without their covariance and details.
RigCalibration rig_from_json(const json& value) {
  require_schema(value, rig_schema);
  RigCalibration rig;
  for (const auto& camera : value.at("cameras")) {
    rig.names.push_back(camera.at("name"));
    rig.cameras.emplace_back().color = camera_from_json(camera.at("camera"));
    rig.camera_from_rig.push_back(pose_from_json(camera.at("camera_from_rig"), "camera_from_rig"));
  }
  rig.parameters = value.at("parameters").get<std::vector<std::string>>();
  const auto size = static_cast<Eigen::Index>(rig.parameters.size());
  rig.covariance = matrix_from_json(value.at("covariance"), size, size);
  rig.details = value.at("details");
  return rig;
}

RigCalibration rig_from_camchain(const std::filesystem::path& file) {
  RigCalibration rig;
  Eigen::Isometry3d camera_from_rig = Eigen::Isometry3d::Identity();
  for (const ChainCamera& camera : read_camchain(file)) {
    camera_from_rig = camera.from_previous * camera_from_rig;
    rig.names.push_back(fmt::format("cam{}", rig.names.size()));
    rig.cameras.emplace_back().color = camera.camera;
    rig.camera_from_rig.push_back(camera_from_rig);
  }
  rig.details = {{"verdict", "IMPORTED"}};
  return rig;
}

}  // namespace

json rig_json(const RigCalibration& rig) {
  json cameras = json::array();
  for (std::size_t i = 0; i < rig.cameras.size(); ++i)
    cameras.push_back({{"name", rig.names[i]},
                       {"camera", camera_json(rig.cameras[i].color)},
                       {"camera_from_rig", matrix_json(rig.camera_from_rig[i].matrix())}});
  return {{"schema", rig_schema},
          {"cameras", cameras},
          {"parameters", rig.parameters},
          {"covariance", matrix_json(rig.covariance)},
          {"details", rig.details}};
}

void write_rig(const std::filesystem::path& folder, const RigCalibration& rig, bool overwrite) {
  FileTexts texts;
  texts["rig.json"] = checked_json_text(rig_json(rig));
  texts["camchain.yaml"] = camchain(rig);
  for (std::size_t i = 1; i < rig.cameras.size(); ++i)
    texts[rig.names.front() + "_" + rig.names[i] + "_opencv.yaml"] =
        stereo_yaml(rig.cameras.front().color, rig.cameras[i].color, rig.camera_from_rig[i]);
  for (std::size_t i = 0; i < rig.cameras.size(); ++i)
    for (auto& [name, text] : calibration_files(rig.cameras[i]))
      texts[rig.names[i] + "/" + name] = std::move(text);
  write_files(folder, texts, overwrite);
}

RigCalibration read_rig(const std::filesystem::path& folder_or_file) {
  const bool is_file = std::filesystem::is_regular_file(folder_or_file);
  if (is_file && folder_or_file.extension() != ".json") return rig_from_camchain(folder_or_file);
  const auto path = is_file ? folder_or_file : folder_or_file / "rig.json";
  const std::string text = read_file(path, max_bytes);
  try {
    return rig_from_json(parse_checked_json(text));
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read rig {}: {}", path.string(), error.what()),
                     "create it again with `touchtrace calibrate --camera`");
  }
}

}  // namespace touchtrace
