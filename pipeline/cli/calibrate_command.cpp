#include <fmt/core.h>

#include <algorithm>

#include "calib/board/charuco.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/files.h"
#include "engine/base/provenance.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct CalibrateOptions {
  std::string recording, images, output;
  int columns = 9, rows = 6;
  double square_mm = 25.0, marker_mm = 18.0;
  std::string markers = "none", lens = "auto";
};

std::vector<std::string> kinds_of_markers() {
  std::vector<std::string> kinds = marker_dictionaries();
  kinds.insert(kinds.begin(), "none");
  return kinds;
}

std::vector<std::string> lens_options() {
  std::vector<std::string> names{"auto"};
  for (const Lens& lens : all_lenses()) names.push_back(lens_name(lens));
  return names;
}

void describe(OptionSet& set, CalibrateOptions& o) {
  set.optional_input("recording", o.recording, "recording whose chessboard views are used");
  set.text("images", o.images,
           "instead of a recording: folder of board images, or a pattern in quotes, or a TUM RGB-D "
           "folder");
  set.integer("columns", o.columns, "inner corners along a row of the board, for --images", 3, 100);
  set.integer("rows", o.rows, "inner corners along a column of the board, for --images", 3, 100);
  set.number("square-mm", o.square_mm, "side of a square of the board [mm], for --images", 0.1,
             1000.0);
  set.choice("markers", o.markers,
             "dictionary of the markers of a ChArUco board, for --images; none: a chessboard",
             kinds_of_markers());
  set.number("marker-mm", o.marker_mm, "side of such a marker [mm]", 0.1, 1000.0);
  set.choice("lens", o.lens, "distortion of the colour camera's lens; auto: what the views tell",
             lens_options());
  set.path(
      "output", o.output,
      "folder for calibration.json, and camera.yaml, camera_opencv.yaml, camchain.yaml for others");
}

BoardObservations observe(const CalibrateOptions& o) {
  if (o.recording.empty() == o.images.empty())
    throw usage_error("calibrate needs either a recording or --images",
                      "see touchtrace calibrate --help");
  if (!o.recording.empty()) return board_views_from_recording(o.recording);
  Chessboard board{o.columns, o.rows, 1e-3 * o.square_mm};
  if (o.markers != "none") board.markers = {o.markers, 1e-3 * o.marker_mm};
  return is_tum_folder(o.images) ? board_views_from_tum(o.images, board)
                                 : board_views_from_images(o.images, board);
}

Provenance provenance_of(const CalibrateOptions& o, const Invocation& invocation,
                         const Stopwatch& stopwatch) {
  auto provenance = start_provenance(calibration_schema, "calibrate");
  provenance.options = invocation.options;
  if (!o.recording.empty()) provenance.add_input(o.recording);
  if (!o.images.empty())
    for (const auto& path : image_files(o.images)) provenance.add_input(path);
  stopwatch.stop(provenance);
  return provenance;
}

std::string list_of(const nlohmann::json& names) {
  return comma_separated(names.get<std::vector<std::string>>());
}

void print_depth(const RgbdCalibration& c) {
  const auto& depth = c.details["depth"];
  fmt::print(
      "depth     true = {:+.2f} mm + {:.5f} x measured; {:.2f} mm RMS in {} samples; 1 m is known "
      "to {:.2f} mm\n",
      1e3 * c.depth_offset_m, c.depth_scale, 1e3 * c.depth_rms_m, depth["samples"].get<int>(),
      1e3 * depth["bias_sigma_at_1m"].get<double>());
  const Eigen::Vector3d place = 1e3 * c.depth_from_color.translation();
  fmt::print(
      "          colour camera at ({:.1f}, {:.1f}, {:.1f}) mm of the depth camera, turned by "
      "{:.3f} degrees\n",
      place.x(), place.y(), place.z(),
      Eigen::AngleAxisd(c.depth_from_color.linear()).angle() * 180.0 / 3.14159265358979323846);
}

/// By how much depth images are late, or why that is not known.
void print_delay(const RgbdCalibration& c) {
  const auto& sigmas = c.details["sigmas"];
  if (!sigmas.contains("depth.delay"))
    fmt::print("          delay of the depth images {}\n",
               c.details["depth"]["delay"].get<std::string>());
  else
    fmt::print("          depth images show what is {:.2f} +- {:.2f} ms later than stamped\n",
               1e3 * c.depth_delay_s, 1e3 * sigmas["depth.delay"].get<double>());
}

void print_board(const RgbdCalibration& c) {
  fmt::print("board     bulges by {:.2f} mm along its columns, {:.2f} mm along its rows\n",
             1e3 * c.board_warp_m[0], 1e3 * c.board_warp_m[1]);
  const auto& deformation = c.details["target_deformation"];
  if (deformation["chosen"] == "free")
    fmt::print("          corners are off by {:.3f} mm: calibrated with the camera (BIC {:+.1f})\n",
               1e3 * deformation["sigma_m"].get<double>(), -deformation["bic_gain"].get<double>());
}

void print_lens(const RgbdCalibration& c) {
  const auto& details = c.details;
  fmt::print("lens      {}; {:.4f} px RMS", details["lens"].get<std::string>(), c.rms_px);
  const auto& held_out = details["held_out"];
  fmt::print(", {} px in views held out\n",
             held_out["held_out_rms_px"].is_number()
                 ? fmt::format("{:.4f}", held_out["held_out_rms_px"].get<double>())
                 : "unknown");
  for (const auto& trial : details["lenses"]) {
    const auto& bic = trial["bic"];
    fmt::print("          {:<10} BIC {}", trial["name"].get<std::string>(),
               bic.is_number() ? fmt::format("{:+.1f}", bic.get<double>()) : "none");
    for (const auto& removed : trial["removed"])
      fmt::print("; without {}: {}", removed["parameter"].get<std::string>(),
                 removed["why"].get<std::string>());
    fmt::print("\n");
  }
  double worst_px = 0.0;
  for (const auto& row : details["projection_sigma_px"])
    for (const auto& sigma : row)
      if (sigma.is_number()) worst_px = std::max(worst_px, sigma.get<double>());
  fmt::print("image     {:.0f} % covered by boards; pixels are known to {:.2f} px at worst\n",
             1e2 * details["coverage"].get<double>(), worst_px);
  print_board(c);
}

void print_summary(const RgbdCalibration& c) {
  const auto& details = c.details;
  const auto& sigma = details["sigmas"];
  fmt::print(
      "camera    fx {:.2f} +- {:.2f}  fy {:.2f} +- {:.2f}  cx {:.2f} +- {:.2f}  cy {:.2f} +- "
      "{:.2f} px\n",
      c.color.fx, sigma["color.fx"].get<double>(), c.color.fy, sigma["color.fy"].get<double>(),
      c.color.cx, sigma["color.cx"].get<double>(), c.color.cy, sigma["color.cy"].get<double>());
  print_lens(c);
  if (c.depth) print_depth(c), print_delay(c);
  if (!details["outlier_views"].empty())
    fmt::print("outliers  left out: {}\n", list_of(details["outlier_views"]));
  if (!details["duplicate_views"].empty())
    fmt::print("twice     {}: counted once\n", list_of(details["duplicate_views"]));
  if (!details["views_without_board"].empty())
    fmt::print("no board  in {}\n", list_of(details["views_without_board"]));
  for (const auto& entry : details["not_identifiable"])
    fmt::print("prior     determines {} (+- {:.3g}): it is not identifiable from these views\n",
               entry["parameter"].get<std::string>(), entry["sigma"].get<double>());
  fmt::print("verdict   {}\n", details["verdict"].get<std::string>());
  for (const auto& advice : details["advice"])
    fmt::print("          {}\n", advice.get<std::string>());
}

ExitCode run(const CalibrateOptions& options, const Invocation& invocation) {
  const Stopwatch stopwatch;
  const OutputFile refuses_what_exists(std::filesystem::path(options.output) / "calibration.json",
                                       invocation.overwrite);
  CalibrationOptions settings{.cross_validate = true};
  if (options.lens != "auto") settings.lenses = {options.lens};
  RgbdCalibration calibration = calibrate(observe(options), settings);
  calibration.details["provenance"] = provenance_of(options, invocation, stopwatch);
  write_calibration(options.output, calibration, invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", calibration_json(calibration).dump(2));
  else
    print_summary(calibration);
  return calibration.details["verdict"] == "BAD" ? ExitCode::data : ExitCode::done;
}

}  // namespace

Command calibrate_command() {
  return make_command<CalibrateOptions>(
      "calibrate",
      "find the camera's intrinsics, depth error and their uncertainty from board views",
      {"touchtrace calibrate recording.h5 --output calibration",
       "touchtrace calibrate --images 'photos/left*.jpg' --columns 9 --rows 6 --square-mm 25 "
       "--output calibration"},
      run);
}

}  // namespace touchtrace::cli
