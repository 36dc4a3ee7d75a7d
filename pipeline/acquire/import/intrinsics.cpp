#include "pipeline/acquire/import/intrinsics.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/rgbd/foreign_calibration.h"
#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t max_bytes = 16u << 20;
// A depth scale is stated as counts per metre, millimetres per count or metres per count. No camera
// has fewer counts per metre than the first, or metres per count than the second.
constexpr double min_counts_per_m = 50.0, max_m_per_count = 0.02, mm_per_m = 1000.0;

std::vector<double> numbers_of(std::string text) {
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

json matrix_of(const json& j) {
  for (const char* key : {"intrinsic_matrix", "camera_matrix", "cam_K", "K", "k"})
    if (j.is_object() && j.contains(key)) return camera_matrix(numbers_of(j.at(key).dump()));
  if (!j.is_object()) return camera_matrix(numbers_of(j.dump()));
  const char *cx = j.contains("ppx") ? "ppx" : "cx", *cy = j.contains("ppy") ? "ppy" : "cy";
  return camera_matrix({j.at("fx"), j.at("fy"), j.at(cx), j.at(cy)});
}

/// Entry of the first image in a scene_camera.json of BOP, which has one per image; else all.
json first_image(const json& j) {
  const bool is_by_image =
      j.is_object() && !j.empty() && j.front().is_object() && j.front().contains("cam_K");
  return is_by_image ? j.front() : j;
}

/// Message of a matrix in text or in JSON, which has a size only sometimes.
json camera_info(const fs::path& file, int width, int height) {
  const std::string text = read_file(file, max_bytes);
  json info{{"width", width}, {"height", height}};
  if (file.extension() != ".json") {
    info["K"] = camera_matrix(numbers_of(text));
    return info;
  }
  const json j = first_image(json::parse(text));
  info["K"] = matrix_of(j);
  for (const char* key : {"width", "height", "distortion_model", "D"})
    if (j.is_object() && j.contains(key)) info[key] = j.at(key);
  for (const char* key : {"coeffs", "dist", "distortion"})
    if (j.is_object() && j.contains(key)) info["D"] = j.at(key);
  return info;
}

/// Whether the file has no more than a camera matrix, which read_calibration() does not read.
bool is_bare_matrix(const fs::path& file) {
  if (file.extension() == ".txt" || file.extension() == ".csv") return true;
  if (file.extension() != ".json") return false;
  const json j = json::parse(read_file(file, max_bytes), nullptr, false);
  const bool is_message = j.contains("K") && j.contains("width");
  return !j.is_discarded() && !j.contains("schema") && !j.contains("image_width") && !is_message;
}

RgbdCalibration read(const fs::path& file, int width, int height) {
  if (!fs::is_regular_file(file) || !is_bare_matrix(file)) return read_calibration(file);
  try {
    RgbdCalibration calibration;
    calibration.color = camera_from_info(camera_info(file, width, height));
    return calibration;
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

}  // namespace

RgbdCalibration read_intrinsics(const fs::path& file, int width, int height) {
  RgbdCalibration calibration = read(file, width, height);
  const Camera& camera = calibration.color;
  if (camera.width != width || camera.height != height)
    throw data_error(fmt::format("{} is for images of {}x{} pixels, these have {}x{}",
                                 file.string(), camera.width, camera.height, width, height),
                     "give the intrinsics of this resolution with --camera-info FILE");
  return calibration;
}

IntrinsicsFiles find_intrinsics(const fs::path& folder) {
  return {find_file(folder,
                    {"camera_info", "camera_info_color", "camera", "intrinsics", "intrinsic",
                     "camera_intrinsics", "camera_intrinsic", "cam_intrinsics", "intrinsics_color",
                     "intrinsic_color", "camera_matrix", "scene_camera", "K", "cam_K"}),
          find_file(folder,
                    {"camera_info_depth", "camera_depth", "intrinsics_depth", "intrinsic_depth"})};
}

std::optional<double> stated_counts_per_m(const fs::path& file) {
  if (file.extension() != ".json" || !fs::is_regular_file(file)) return std::nullopt;
  const json j = json::parse(read_file(file, max_bytes), nullptr, false);
  if (j.is_discarded() || !j.is_object()) return std::nullopt;
  const json entry = first_image(j);
  const auto stated = entry.find("depth_scale");
  if (stated == entry.end() || !stated->is_number()) return std::nullopt;
  const auto scale = stated->get<double>();
  if (!(scale > 0.0)) return std::nullopt;
  if (scale >= min_counts_per_m) return scale;
  return scale > max_m_per_count ? mm_per_m / scale : 1.0 / scale;
}

}  // namespace touchtrace
