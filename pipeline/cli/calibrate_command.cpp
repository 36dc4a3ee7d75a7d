#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/board/markers.h"
#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/comparison.h"
#include "calib/rgbd/next_view.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/provenance.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_size.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/cli/calibrate_rig.h"
#include "pipeline/cli/calibrate_summary.h"
#include "pipeline/cli/calibrate_watch.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct CalibrateOptions {
  std::string recording, corners, output = "camera";
  std::vector<std::string> images, cameras, compare;
  int columns = 0, rows = 0;
  double square_mm = 25.0, marker_mm = 18.0, tag_spacing = 0.3;
  std::string target = "chessboard", markers = "none", lens = "auto";
  bool watch = false, no_warp = false, no_target_deformation = false;
};

std::vector<std::string> target_choices() {
  std::vector<std::string> names;
  for (const TargetKind* kind : target_kinds()) names.emplace_back(kind->name);
  return names;
}

std::vector<std::string> marker_choices() {
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
  set.optional_input("recording", o.recording,
                     "HDF5 with board views, or photographs as for --images");
  set.text("output", o.output,
           "folder for calibration.json and, for ROS, OpenCV and kalibr, camera.yaml, "
           "camera_opencv.yaml, camchain.yaml")
      .value("DIR");
  set.choice("lens", o.lens, "distortion model of the colour camera; auto: selected by BIC",
             lens_options());
  set.flag("no-warp", o.no_warp, "the board is flat: do not estimate its warp");
  set.flag("no-target-deformation", o.no_target_deformation,
           "do not estimate offsets of the board's corners");
  set.texts("compare", o.compare, "two calibrations: do they agree within their covariance?")
      .value("CALIBRATION");
  set.group("Images instead of a recording");
  set.texts("images", o.images, "folder, files, glob pattern, or TUM RGB-D folder").value("PATH");
  set.flag("watch", o.watch,
           "wait for images in the folder, say which view helps most, end when the calibration is "
           "GOOD");
  set.texts("camera", o.cameras,
            "two or more cameras of a rig, e.g. left=photos/left right=photos/right: images as for "
            "--images, or a file as for --corners")
      .value("NAME=PATH");
  set.text("corners", o.corners,
           "detected corners: calibration.json, or text of mrcal ('filename x y level')")
      .value("FILE");
  set.choice("target", o.target, "kind of calibration target", target_choices());
  set.integer(
      "columns", o.columns,
      "inner corners, circles or tags per row; 0: as the chessboard in the images has, or 9", 0,
      100);
  set.integer("rows", o.rows, "the same per column; 0: as in the images, or 6", 0, 100);
  set.number("square-mm", o.square_mm,
             "side of a square, distance of circles, or of rows of asymmetric circles [mm]", 0.1,
             1000.0)
      .value("MM");
  set.choice("markers", o.markers,
             "dictionary of a ChArUco board or ArUco grid, e.g. 5x5_100; none: no such target",
             marker_choices())
      .value("DICTIONARY");
  set.number("marker-mm", o.marker_mm, "side of a marker or tag [mm]", 0.1, 1000.0).value("MM");
  set.number("tag-spacing", o.tag_spacing, "space between the tags of a grid over their side", 0.01,
             2.0);
}

/// The images that tell the size of the board.
std::vector<std::filesystem::path> sizing_images(const CalibrateOptions& o) {
  if (o.target != chessboard_kind.name || o.markers != "none" || o.watch) return {};
  return o.cameras.empty() ? image_files(o.images) : images_of_rig(o.cameras);
}

BoardSize board_size_of(const CalibrateOptions& o) {
  if ((o.columns == 0) != (o.rows == 0))
    throw usage_error("--columns and --rows go together", "give both or none");
  if (o.columns > 0) return {o.columns, o.rows};
  if (const auto size = o.corners.empty() ? std::nullopt : board_size_of_corners(o.corners))
    return *size;
  const auto images = sizing_images(o);
  if (images.empty()) return {CalibrationTarget{}.columns, CalibrationTarget{}.rows};
  const BoardSize size = find_board_size(images);
  Progress::report(fmt::format("the board has {}x{} inner corners", size.columns, size.rows));
  report_markers(images);
  return size;
}

/// Dictionary of the target's markers, if it has any.
std::optional<std::string> dictionary_of(const CalibrateOptions& o, const TargetKind& kind) {
  if (!kind.dictionary) return {};
  if (kind.dictionary != any_dictionary) return kind.dictionary;
  if (o.markers == "none")
    throw usage_error(fmt::format("a target of kind {} needs a dictionary of markers", kind.name),
                      "add e.g. --markers 5x5_100");
  return o.markers;
}

CalibrationTarget target_of(const CalibrateOptions& o) {
  const BoardSize size = board_size_of(o);
  CalibrationTarget target{size.columns, size.rows, 1e-3 * o.square_mm};
  target.kind = *std::ranges::find(target_kinds(), o.target, &TargetKind::name);
  if (target.kind == &chessboard_kind && o.markers != "none") target.kind = &charuco_kind;
  if (const auto dictionary = dictionary_of(o, *target.kind))
    target.markers = {*dictionary, 1e-3 * o.marker_mm};
  if (target.kind->element_corners == 2) {
    target.columns *= 2, target.rows *= 2;
    target.square_m = target.markers->side_m * (1.0 + o.tag_spacing);
  } else if (std::min(size.columns, size.rows) < 3) {
    throw usage_error(fmt::format("a {} of {}x{} is too small", o.target, size.columns, size.rows),
                      "give --columns and --rows of 3 or more");
  }
  target.is_flat = o.no_warp;
  return target;
}

/// Options with photographs that were given in place of a recording among the images.
CalibrateOptions with_images(CalibrateOptions o) {
  require_no_video(o.recording);
  if (may_be_images(o.recording)) o.images.push_back(std::exchange(o.recording, ""));
  return o;
}

void require_one_input(const CalibrateOptions& o) {
  const int inputs =
      !o.recording.empty() + !o.images.empty() + !o.corners.empty() + !o.cameras.empty();
  if (inputs != 1)
    throw usage_error(inputs == 0
                          ? "missing RECORDING, --images PATH, --corners FILE or --camera NAME=PATH"
                          : "RECORDING, --images, --corners and --camera cannot be combined",
                      "give exactly one of them; touchtrace calibrate --help describes them");
  if (o.watch && o.images.size() != 1)
    throw usage_error("--watch takes one folder",
                      "run `touchtrace calibrate --images FOLDER --watch`");
}

BoardObservations observe(const CalibrateOptions& o) {
  if (!o.recording.empty()) {
    BoardObservations observations = board_views_from_recording(o.recording);
    observations.board.is_flat = o.no_warp;
    return observations;
  }
  const CalibrationTarget board = target_of(o);
  if (!o.corners.empty()) return board_views_from_corners(o.corners, board);
  return o.images.size() == 1 && is_tum_folder(o.images.front())
             ? board_views_from_tum(o.images.front(), board)
             : board_views_from_images(o.images, board);
}

Provenance provenance_of(const CalibrateOptions& o, const Invocation& invocation,
                         const Stopwatch& stopwatch) {
  auto provenance = start_provenance(calibration_schema, "calibrate");
  provenance.options = invocation.options;
  if (!o.recording.empty()) provenance.add_input(o.recording);
  if (!o.corners.empty()) provenance.add_input(o.corners);
  if (!o.images.empty())
    for (const auto& path : image_files(o.images)) provenance.add_input(path);
  stopwatch.stop(provenance);
  return provenance;
}

ExitCode run_comparison(const std::vector<std::string>& files, bool as_json) {
  if (files.size() != 2)
    throw usage_error("--compare takes two calibrations",
                      "run `touchtrace calibrate --compare A B`");
  if (is_rig(files[0]) || is_rig(files[1])) return compare_rigs(files[0], files[1], as_json);
  const auto difference = compare(read_calibration(files[0]), read_calibration(files[1]));
  if (as_json) {
    fmt::print("{}\n", difference_json(difference).dump(2));
    return ExitCode::done;
  }
  print_comparison(difference);
  return ExitCode::done;
}

BoardObservations watch(const CalibrateOptions& options, const CalibrationOptions& settings,
                        const Invocation& invocation) {
  CalibrationOptions quick = settings;
  quick.cross_validate = false;
  return watch_folder({options.images.front(), options.output, target_of(options), quick},
                      invocation);
}

/// Says which further view would help most, unless all is well.
void add_next_view(RgbdCalibration& calibration, const CalibrationTarget& board) {
  if (calibration.details["verdict"] == "GOOD") return;
  const auto next = find_next_view(calibration, board);
  if (!next) return;
  std::string gain;
  if (std::isfinite(next->then_px))
    gain = fmt::format(
        ": four fifths of the image are then known to {:.2f} px{}", next->then_px,
        std::isfinite(next->sigma_px) ? fmt::format(" instead of {:.2f}", next->sigma_px) : "");
  calibration.details["next_view"] = describe(*next) + gain;
}

ExitCode run(const CalibrateOptions& given, const Invocation& invocation) {
  if (!given.compare.empty()) return run_comparison(given.compare, invocation.json);
  const CalibrateOptions options = with_images(given);
  require_one_input(options);
  CalibrationOptions settings{.target_deformation = !options.no_target_deformation,
                              .cross_validate = true};
  if (options.lens != "auto") settings.lenses = {options.lens};
  if (!options.cameras.empty())
    return calibrate_rig({options.cameras, target_of(options), settings, options.output},
                         invocation);
  const Stopwatch stopwatch;
  const OutputFile refuses_existing(std::filesystem::path(options.output) / "calibration.json",
                                    invocation.overwrite);
  const BoardObservations observations =
      options.watch ? watch(options, settings, invocation) : observe(options);
  RgbdCalibration calibration = calibrate(observations, settings);
  add_next_view(calibration, observations.board);
  const CalibrationTarget& board = observations.board;
  calibration.details["board"] = {{"target", board.kind->name},
                                  {"columns", board.columns},
                                  {"rows", board.rows},
                                  {"square_m", board.square_m}};
  calibration.details["provenance"] = provenance_of(options, invocation, stopwatch);
  write_calibration(options.output, calibration, invocation.overwrite || options.watch);
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
      "calibrate an RGB-D camera from board views: lens, depth error, poses, with covariance",
      {"touchtrace calibrate wave.h5 --output camera",
       "touchtrace calibrate photos --square-mm 25 --output camera",
       "touchtrace calibrate --images 'photos/left*.jpg' --columns 9 --rows 6",
       "touchtrace calibrate --camera left=photos/left right=photos/right --output stereo",
       "touchtrace calibrate --images photos --target aprilgrid --columns 6 --rows 6 "
       "--marker-mm 88",
       "touchtrace calibrate --compare camera camera_of_last_month"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
