#include <fmt/core.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "calib/rgbd/calibration_json.h"
#include "calib/rgbd/camera_info.h"
#include "calib/rgbd/foreign_calibration.h"
#include "engine/base/checksum.h"
#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr std::uintmax_t max_bytes = 64u << 20;
/// Largest deviation of R R' from the identity: rotations that are printed with three decimals have
/// up to 0.002. Above that of doubles, the nearest rotation replaces the one in the file.
constexpr double max_rotation_deviation = 0.005, rounding_deviation = 1e-12;

json numbers(const double* values, Eigen::Index count) {
  return std::vector<double>(values, values + count);
}

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

double number(const json& value) {
  const double result = value.get<double>();
  require(std::isfinite(result), "a number is not finite");
  return result;
}

int image_size(const json& value) {
  const double size = number(value);
  require(size >= 1.0 && size <= 1e5, "an image size is out of range");
  return static_cast<int>(size);
}

std::vector<double> numbers(const json& values, std::size_t count) {
  require(values.is_array() && values.size() == count, fmt::format("expected {} numbers", count));
  std::vector<double> result;
  for (const auto& value : values) result.push_back(number(value));
  return result;
}

/// Renames keys that older versions wrote.
json with_current_keys(json details) {
  constexpr std::pair<const char*, const char*> renamed[] = {{"board_print", "target_deformation"},
                                                             {"not_told", "not_identifiable"}};
  for (const auto& [before, now] : renamed)
    if (details.is_object() && details.contains(before)) {
      details[now] = details[before];
      details.erase(before);
    }
  return details;
}

/// Whether a text is a JSON document of another program, such as a camera_info.
bool is_foreign_json(const std::string& text) {
  const json document = json::parse(text, nullptr, false);
  return document.is_object() && !document.contains("schema");
}

}  // namespace

json matrix_json(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd row = matrix.row(i).transpose();
    rows.push_back(numbers(row.data(), row.size()));
  }
  return rows;
}

json camera_json(const Camera& camera) {
  json distortion = json::object();
  const auto names = coefficient_names(camera.lens);
  for (std::size_t i = 0; i < names.size(); ++i)
    distortion[names[i]] = camera.distortion[static_cast<Eigen::Index>(i)];
  return {{"width", camera.width},
          {"height", camera.height},
          {"lens", lens_name(camera.lens)},
          {"intrinsics_px", {camera.fx, camera.fy, camera.cx, camera.cy}},
          {"distortion", distortion}};
}

Eigen::MatrixXd matrix_from_json(const json& rows, Eigen::Index height, Eigen::Index width) {
  require(rows.is_array() && static_cast<Eigen::Index>(rows.size()) == height,
          fmt::format("expected {} rows", height));
  Eigen::MatrixXd result(height, width);
  for (Eigen::Index i = 0; i < height; ++i) {
    const auto row = numbers(rows[static_cast<std::size_t>(i)], static_cast<std::size_t>(width));
    result.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), width);
  }
  return result;
}

Camera camera_from_json(const json& value) {
  Camera camera;
  camera.width = image_size(value.at("width"));
  camera.height = image_size(value.at("height"));
  const auto intrinsics = numbers(value.at("intrinsics_px"), 4);
  const std::string lens = value.at("lens");
  require(find_lens(lens).has_value(), fmt::format("unknown lens '{}'", lens));
  camera.lens = *find_lens(lens);
  camera.fx = intrinsics[0], camera.fy = intrinsics[1];
  camera.cx = intrinsics[2], camera.cy = intrinsics[3];
  const auto names = coefficient_names(camera.lens);
  for (std::size_t i = 0; i < names.size(); ++i)
    camera.distortion[static_cast<Eigen::Index>(i)] = number(value.at("distortion").at(names[i]));
  require(camera.fx > 0.0 && camera.fy > 0.0, "a focal length is not positive");
  return camera;
}

Eigen::Isometry3d pose_from_json(const json& value, const std::string& name) {
  Eigen::Isometry3d pose;
  pose.matrix() = matrix_from_json(value, 4, 4);
  const Eigen::Matrix3d rotation = pose.linear();
  const double deviation =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  require(deviation <= max_rotation_deviation && rotation.determinant() > 0.0 &&
              pose.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1),
          fmt::format("{} is not a rigid motion: R R' is off the identity by {:.2g} (at most {}), "
                      "or the last row is not 0 0 0 1",
                      name, deviation, max_rotation_deviation));
  if (deviation > rounding_deviation) pose.linear() = Eigen::Affine3d(pose.matrix()).rotation();
  return pose;
}

RgbdCalibration calibration_from_json(const json& value) {
  require_schema(value, calibration_schema);
  RgbdCalibration c;
  c.color = camera_from_json(value.at("color"));
  if (!value.at("depth").is_null()) c.depth = camera_from_json(value.at("depth"));
  c.depth_from_color = pose_from_json(value.at("depth_from_color"), "depth_from_color");
  c.depth_scale = number(value.at("depth_scale"));
  require(c.depth_scale > 0.0, "depth_scale is not positive");
  c.depth_offset_m = number(value.at("depth_offset_m"));
  c.depth_delay_s = number(value.at("depth_delay_s"));
  const auto warp_m = numbers(value.at("board_warp_m"), 2);
  c.board_warp_m = {warp_m[0], warp_m[1]};
  c.rms_px = number(value.at("rms_px"));
  c.depth_rms_m = number(value.at("depth_rms_m"));
  c.parameters = value.at("parameters").get<std::vector<std::string>>();
  const auto size = static_cast<Eigen::Index>(c.parameters.size());
  c.covariance = matrix_from_json(value.at("covariance"), size, size);
  c.details = with_current_keys(value.at("details"));
  return c;
}

json calibration_json(const RgbdCalibration& c) {
  return {{"schema", calibration_schema},
          {"color", camera_json(c.color)},
          {"depth", c.depth ? camera_json(*c.depth) : json()},
          {"depth_from_color", matrix_json(c.depth_from_color.matrix())},
          {"depth_scale", c.depth_scale},
          {"depth_offset_m", c.depth_offset_m},
          {"depth_delay_s", c.depth_delay_s},
          {"board_warp_m", c.board_warp_m},
          {"rms_px", c.rms_px},
          {"depth_rms_m", c.depth_rms_m},
          {"parameters", c.parameters},
          {"covariance", matrix_json(c.covariance)},
          {"details", c.details}};
}

std::string checked_json_text(json document) {
  document[checksum_key] = empty_checksum();
  return with_checksum(document.dump(1) + "\n");
}

json parse_checked_json(const std::string& text) {
  verify_checksum(text, text);
  return json::parse(text);
}

void require_schema(const json& document, const std::string& schema) {
  const json& found = document.at("schema");
  require(found == schema, fmt::format("schema {} is not {}", found.dump(), schema));
}

FileTexts calibration_files(const RgbdCalibration& calibration) {
  FileTexts texts;
  texts["camera.yaml"] = camera_info_yaml("color", calibration.color);
  texts["camera_opencv.yaml"] = file_storage_yaml(calibration.color);
  if (calibration.depth) {
    texts["camera_depth.yaml"] = camera_info_yaml("depth", *calibration.depth);
    texts["camera_depth_opencv.yaml"] = file_storage_yaml(*calibration.depth);
  }
  texts["camchain.yaml"] = camchain_yaml(calibration);
  texts["calibration.json"] = checked_json_text(calibration_json(calibration));
  return texts;
}

void write_files(const std::filesystem::path& folder, const FileTexts& texts, bool overwrite) {
  for (const auto& [name, text] : texts)
    OutputFile(folder / name, overwrite);  // throws before any file is written
  for (const auto& [name, text] : texts) write_file(folder / name, text, overwrite);
}

void write_calibration(const std::filesystem::path& folder, const RgbdCalibration& calibration,
                       bool overwrite) {
  write_files(folder, calibration_files(calibration), overwrite);
}

RgbdCalibration read_calibration(const std::filesystem::path& folder_or_file) {
  const bool is_file = std::filesystem::is_regular_file(folder_or_file);
  if (is_file && folder_or_file.extension() != ".json")
    return read_foreign_calibration(folder_or_file);
  if (!std::filesystem::exists(folder_or_file))
    throw data_error(fmt::format("{} does not exist", folder_or_file.string()), "check the path");
  const auto path = is_file ? folder_or_file : folder_or_file / "calibration.json";
  const std::string text = read_file(path, max_bytes);
  if (is_file && is_foreign_json(text)) return read_foreign_calibration(path);
  try {
    return calibration_from_json(parse_checked_json(text));
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read calibration {}: {}", path.string(), error.what()),
                     "create it again with `touchtrace calibrate`");
  }
}

}  // namespace touchtrace
