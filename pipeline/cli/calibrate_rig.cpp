#include "pipeline/cli/calibrate_rig.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <numbers>

#include "calib/rig/calibrate_rig.h"
#include "calib/rig/rig_comparison.h"
#include "engine/base/files.h"
#include "engine/base/provenance.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr double degrees_per_rad = 180.0 / std::numbers::pi;

/// Images, or a file of detected corners, of one camera.
struct CameraImages {
  std::string name, path;

  bool is_corner_file() const { return fs::is_regular_file(path); }
};

/// Names become folders, file names and parts of parameter names.
bool is_camera_name(const std::string& name) {
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

CameraImages parse_source(const std::string& text) {
  const auto equals = text.find('=');
  CameraImages source;
  source.path = equals == std::string::npos ? text : text.substr(equals + 1);
  source.name = equals == std::string::npos
                    ? (fs::path(text) / "").parent_path().filename().string()
                    : text.substr(0, equals);
  if (!is_camera_name(source.name) || source.path.empty())
    throw usage_error(fmt::format("cannot read the camera '{}'", text),
                      "write --camera NAME=PATH, where NAME has letters, digits, - and _");
  return source;
}

std::vector<CameraImages> parse_sources(const std::vector<std::string>& texts) {
  if (texts.size() < 2)
    throw usage_error("--camera needs two or more cameras",
                      "give --camera left=PATH right=PATH, or for one camera --images PATH");
  std::vector<CameraImages> sources;
  for (const auto& text : texts) {
    sources.push_back(parse_source(text));
    const auto& name = sources.back().name;
    if (std::ranges::count(sources, name, &CameraImages::name) > 1)
      throw usage_error(fmt::format("two cameras have the name '{}'", name),
                        "give each camera a name: --camera NAME=PATH");
  }
  return sources;
}

std::vector<RigInput> observe(const std::vector<CameraImages>& sources,
                              const CalibrationTarget& board) {
  std::vector<RigInput> inputs;
  for (const auto& source : sources)
    inputs.push_back({source.name, source.is_corner_file()
                                       ? board_views_from_corners(source.path, board)
                                       : board_views_from_images({source.path}, board)});
  return inputs;
}

Provenance provenance_of(const std::vector<CameraImages>& sources, const Invocation& invocation,
                         const Stopwatch& stopwatch) {
  auto provenance = start_provenance(rig_schema, "calibrate");
  provenance.options = invocation.options;
  for (const auto& source : sources)
    for (const auto& path : image_files({source.path})) provenance.add_input(path);
  stopwatch.stop(provenance);
  return provenance;
}

void print_camera(const RigCalibration& rig, std::size_t camera) {
  const RgbdCalibration& c = rig.cameras[camera];
  const auto& sigma = c.details["sigmas"];
  fmt::print(
      "{:<9} {}; {:.4f} px RMS; fx {:.2f} +- {:.2f}  fy {:.2f} +- {:.2f}  cx {:.2f} +- {:.2f}  cy "
      "{:.2f} +- {:.2f} px\n",
      rig.names[camera], lens_name(c.color.lens), c.rms_px, c.color.fx,
      sigma["color.fx"].get<double>(), c.color.fy, sigma["color.fy"].get<double>(), c.color.cx,
      sigma["color.cx"].get<double>(), c.color.cy, sigma["color.cy"].get<double>());
  if (camera == 0) return;
  const RelativePose pose = relative_pose(rig, camera);
  const Eigen::Vector3d t = 1e3 * rig.camera_from_rig[camera].translation();
  fmt::print(
      "          {} from {}: baseline {:.3f} +- {:.3f} mm, rotation {:.4f} +- {:.4f} degrees; T = "
      "({:.2f}, {:.2f}, {:.2f}) mm\n",
      rig.names[camera], rig.names.front(), 1e3 * pose.baseline_m, 1e3 * pose.baseline_sigma_m,
      degrees_per_rad * pose.rotation_rad, degrees_per_rad * pose.rotation_sigma_rad, t.x(), t.y(),
      t.z());
}

void print_summary(const RigCalibration& rig) {
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) print_camera(rig, i);
  const auto& details = rig.details;
  for (const auto& pair : details["epipolar"])
    fmt::print("epipolar  {} px RMS between {} and {} in {} held-out frames\n",
               pair["rms_px"].is_number() ? fmt::format("{:.4f}", pair["rms_px"].get<double>())
                                          : "unknown",
               pair["cameras"][0].get<std::string>(), pair["cameras"][1].get<std::string>(),
               pair["frames"].get<int>());
  if (const double inflation = details["frame_inflation"]; inflation > 1.0)
    fmt::print(
        "          corners of a frame err together: standard deviations are {:.1f} times those of "
        "independent corners\n",
        inflation);
  if (!details["outlier_frames"].empty())
    fmt::print("outliers  excluded frames: {}\n",
               comma_separated(details["outlier_frames"].get<std::vector<std::string>>()));
  fmt::print("verdict   {}\n", details["verdict"].get<std::string>());
  for (const auto& advice : details["advice"])
    fmt::print("          {}\n", advice.get<std::string>());
}

}  // namespace

std::vector<fs::path> images_of_rig(const std::vector<std::string>& cameras) {
  std::vector<fs::path> images;
  for (const auto& source : parse_sources(cameras))
    if (!source.is_corner_file())
      std::ranges::copy(image_files({source.path}), std::back_inserter(images));
  return images;
}

bool is_rig(const std::string& path) {
  return fs::path(path).filename() == "rig.json" || fs::exists(fs::path(path) / "rig.json");
}

ExitCode compare_rigs(const std::string& a, const std::string& b, bool as_json) {
  const RigCalibration first = read_rig(a);
  const auto differences = compare(first, read_rig(b));
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const auto& d = differences[i];
    list.push_back({{"camera", first.names[i + 1]},
                    {"position_m", d.position_m},
                    {"rotation_rad", d.rotation_rad},
                    {"rms_sigmas", d.rms_sigmas},
                    {"agree", d.agrees()}});
    if (!as_json)
      fmt::print(
          "{:<9} moved by {:.3f} mm and {:.4f} degrees: {:.1f} standard deviations (RMS); {}\n",
          first.names[i + 1], 1e3 * d.position_m, degrees_per_rad * d.rotation_rad, d.rms_sigmas,
          d.agrees() ? "the poses agree" : "the poses differ");
  }
  if (as_json) fmt::print("{}\n", list.dump(2));
  return ExitCode::done;
}

ExitCode calibrate_rig(const RigOptions& options, const Invocation& invocation) {
  const Stopwatch stopwatch;
  const auto sources = parse_sources(options.cameras);
  const OutputFile refuses_existing(fs::path(options.output) / "rig.json", invocation.overwrite);
  RigCalibration rig = calibrate_rig(observe(sources, options.board), options.calibration);
  rig.details["provenance"] = provenance_of(sources, invocation, stopwatch);
  for (auto& camera : rig.cameras) camera.details["provenance"] = rig.details["provenance"];
  write_rig(options.output, rig, invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", rig_json(rig).dump(2));
  else
    print_summary(rig);
  return rig.details["verdict"] == "BAD" ? ExitCode::data : ExitCode::done;
}

}  // namespace touchtrace::cli
