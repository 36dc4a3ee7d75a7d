#include "pipeline/acquire/import/intrinsics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/rgbd/foreign_calibration.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/import/formats/name_words.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t max_bytes = 16u << 20;
// A depth scale is stated as counts per metre, millimetres per count or metres per count. No camera
// has fewer counts per metre than the first, or metres per count than the second.
constexpr double min_counts_per_m = 50.0, max_m_per_count = 0.02, mm_per_m = 1000.0;

std::vector<double> numbers_in(std::string text) {
  for (char& c : text)
    if (std::string_view("[](),;").find(c) != std::string_view::npos) c = ' ';
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double value; words >> value;) numbers.push_back(value);
  if (!words.eof()) throw std::runtime_error("it has other text than numbers");
  return numbers;
}

/// Camera matrix, row by row, from its rows, its columns, the rows of a 4x4 matrix, or fx fy cx cy.
json camera_matrix(const std::vector<double>& n) {
  if (n.size() == 16) return {n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]};
  if (n.size() == 4) return {n[0], 0.0, n[2], 0.0, n[1], n[3], 0.0, 0.0, 1.0};
  if (n.size() != 9)
    throw std::runtime_error(fmt::format("{} numbers instead of a 3x3 camera matrix", n.size()));
  const bool is_column_major = n[2] == 0.0 && n[5] == 0.0 && n[6] != 0.0;
  if (is_column_major) return {n[0], n[3], n[6], n[1], n[4], n[7], n[2], n[5], n[8]};
  return n;
}

std::vector<double> numbers_of(const json& j) {
  const bool is_opencv_matrix = j.is_object() && j.contains("data");
  return numbers_in((is_opencv_matrix ? j.at("data") : j).dump());
}

/// M1: left camera of OpenCV's stereo_calib.
constexpr std::array matrix_keys{"intrinsic_matrix", "camera_matrix", "cam_K", "K", "k", "M1"};

bool has_camera(const json& j) {
  return !j.is_object() || (j.contains("fx") && j.contains("fy")) ||
         (j.contains("px") && j.contains("u0")) ||
         std::ranges::any_of(matrix_keys, [&](const char* key) { return j.contains(key); });
}

json matrix_of(const json& j) {
  if (!j.is_object()) return camera_matrix(numbers_of(j));
  for (const char* key : matrix_keys)
    if (j.contains(key)) return camera_matrix(numbers_of(j.at(key)));
  if (j.contains("u0"))  // ViSP
    return camera_matrix({j.at("px"), j.at("py"), j.at("u0"), j.at("v0")});
  const char *cx = j.contains("ppx") ? "ppx" : "cx", *cy = j.contains("ppy") ? "ppy" : "cy";
  return camera_matrix({j.at("fx"), j.at("fy"), j.at(cx), j.at(cy)});
}

constexpr std::array distortion_keys{"D",          "coeffs",           "dist",
                                     "distortion", "dist_coeff",       "dist_coeffs",
                                     "distCoeffs", "dist_coefs",       "distortion_coefficients",
                                     "D1",         "distortion_coeffs"};

/// k1, k2, p1, p2, k3 and so on, in OpenCV's order; empty: none.
std::vector<double> distortion_of(const json& j) {
  for (const char* key : distortion_keys)
    if (j.contains(key) && !j.at(key).is_null()) return numbers_of(j.at(key));
  if (!j.contains("k1") || !j.contains("p1")) {
    for (const auto& [key, value] : j.items())
      if ((lower_case(key).starts_with("dist") && key != "distortion_model") || key == "k1")
        Progress::warn(fmt::format("'{}' of the intrinsics is not read: no lens distortion", key));
    return {};
  }
  std::vector<double> coefficients;
  for (const char* key : {"k1", "k2", "p1", "p2", "k3"}) coefficients.push_back(j.value(key, 0.0));
  return coefficients;
}

/// Camera.fx, Camera1.fx, ... of ORB-SLAM as fx, ...
json without_prefix(const json& j) {
  json flat = json::object();
  for (const auto& [key, value] : j.items())
    for (const std::string prefix : {"Camera.", "Camera1."})
      if (key.starts_with(prefix)) flat[key.substr(prefix.size())] = value;
  return flat;
}

/// The part of `j` that describes the colour camera: `j` itself, its fields with a prefix, the
/// entry that is named after colour, or the first that is not of a depth or infrared camera. A
/// scene_camera.json of BOP has an entry for each image.
json color_entry(const json& j) {
  if (has_camera(j)) return j;
  if (const json flat = without_prefix(j); has_camera(flat)) return flat;
  for (const bool is_named : {true, false})
    for (const auto& [key, value] : j.items())
      if (value.is_object() && has_camera(value) &&
          (is_named ? names_color(key) : !names_depth(key) && !names_other_image(key)))
        return value;
  throw std::runtime_error(
      "it has neither a camera matrix nor fx, fy, cx and cy of the colour camera");
}

json document_of(const fs::path& file) {
  const std::string text = read_file(file, max_bytes);
  return file.extension() == ".json" ? json::parse(text) : parse_yaml(text);
}

bool is_text(const fs::path& file) {
  return file.extension() == ".txt" || file.extension() == ".csv";
}

/// Whether read_calibration() reads a document: ours, a camera_info, cv::FileStorage or camchain.
bool is_calibration(const json& j) {
  const auto has = [&](const char* key) { return j.is_object() && j.contains(key); };
  return has("schema") || has("image_width") || has("cam0") ||
         ((has("K") || has("k")) && has("width"));
}

/// Message of a matrix in text, JSON or YAML, which has a size only sometimes. nullopt: a file that
/// read_calibration() reads.
std::optional<json> camera_info(const fs::path& file, int width, int height) {
  json info{{"width", width}, {"height", height}};
  if (is_text(file)) {
    info["K"] = camera_matrix(numbers_in(read_file(file, max_bytes)));
    return info;
  }
  const json document = document_of(file);
  if (is_calibration(document)) return std::nullopt;
  const json j = color_entry(document);
  info["K"] = matrix_of(j);
  if (!j.is_object()) return info;
  for (const char* key : {"width", "height", "distortion_model"})
    if (j.contains(key)) info[key] = j.at(key);
  if (auto distortion = distortion_of(j); !distortion.empty()) info["D"] = std::move(distortion);
  return info;
}

RgbdCalibration read(const fs::path& file, int width, int height) {
  if (!fs::is_regular_file(file)) return read_calibration(file);
  if (file.extension() == ".xml")
    throw data_error(fmt::format("{} is XML, which is not read", file.string()),
                     "write the calibration with cv::FileStorage to a file that ends with .yml");
  try {
    const auto info = camera_info(file, width, height);
    if (!info) return read_calibration(file);
    RgbdCalibration calibration;
    calibration.color = camera_from_info(*info);
    return calibration;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read intrinsics {}: {}", file.string(), error.what()),
                     "write the 3x3 camera matrix or fx fy cx cy, or a camera_info");
  }
}

std::optional<fs::path> find_file(const fs::path& folder,
                                  std::initializer_list<const char*> names) {
  for (const std::string name : names)
    for (const char* extension : {".yaml", ".yml", ".json", ".txt", ".csv"})
      if (fs::is_regular_file(folder / (name + extension))) return folder / (name + extension);
  return std::nullopt;
}

/// metadata.json, if it has a camera, as exports of Record3D have it.
std::optional<fs::path> record3d_metadata(const fs::path& folder) {
  const fs::path file = folder / "metadata.json";
  if (!fs::is_regular_file(file)) return std::nullopt;
  const json document = json::parse(read_file(file, max_bytes), nullptr, false);
  return document.is_object() && has_camera(document) ? std::optional(file) : std::nullopt;
}

}  // namespace

RgbdCalibration read_intrinsics(const fs::path& file, int width, int height) {
  RgbdCalibration calibration = read(file, width, height);
  const Camera& camera = calibration.color;
  if (camera.width != width || camera.height != height)
    throw data_error(fmt::format("{} is for images of {}x{} pixels, these have {}x{}",
                                 file.string(), camera.width, camera.height, width, height),
                     "give the intrinsics of this resolution (import --camera-info FILE, label "
                     "--calibration FILE)");
  return calibration;
}

IntrinsicsFiles find_intrinsics(const fs::path& folder) {
  auto color = find_file(
      folder, {"camera_info", "camera_info_color", "camera", "intrinsics", "intrinsic",
               "camera_intrinsics", "camera_intrinsic", "cam_intrinsics", "intrinsics_color",
               "intrinsic_color", "camera_matrix", "scene_camera", "K", "cam_K", "cam"});
  return {color ? color : record3d_metadata(folder),
          find_file(folder,
                    {"camera_info_depth", "camera_depth", "intrinsics_depth", "intrinsic_depth"})};
}

std::optional<double> stated_counts_per_m(const fs::path& file) {
  if (file.extension() != ".json" || !fs::is_regular_file(file)) return std::nullopt;
  const json j = json::parse(read_file(file, max_bytes), nullptr, false);
  if (j.is_discarded() || !j.is_object()) return std::nullopt;
  const bool is_by_image = !j.contains("depth_scale") && !j.empty() && j.front().is_object();
  const json& entry = is_by_image ? j.front() : j;
  const auto stated = entry.find("depth_scale");
  if (stated == entry.end() || !stated->is_number()) return std::nullopt;
  const auto scale = stated->get<double>();
  if (!(scale > 0.0)) return std::nullopt;
  if (scale >= min_counts_per_m) return scale;
  return scale > max_m_per_count ? mm_per_m / scale : 1.0 / scale;
}

}  // namespace touchtrace
