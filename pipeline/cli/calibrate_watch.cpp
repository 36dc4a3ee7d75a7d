#include "pipeline/cli/calibrate_watch.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <thread>

#include "calib/board/board_detector.h"
#include "calib/rgbd/next_view.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/verdict.h"
#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds polling_interval(250);

/// Reports the files of a folder once they are complete.
class FolderWatch {
 public:
  explicit FolderWatch(fs::path folder) : folder_(std::move(folder)) {}

  /// Images that did not change between the last two calls, and were not returned as they are.
  std::vector<fs::path> new_images() {
    std::vector<fs::path> complete;
    for (const auto& path : images_in_folder(folder_)) {
      std::error_code vanished;
      const State state{fs::file_size(path, vanished), fs::last_write_time(path, vanished)};
      auto& [last, is_returned] = files_[path];
      if (state != last) is_returned = false;
      if (!vanished && !is_returned && state == last) {
        complete.push_back(path);
        is_returned = true;
      }
      last = state;
    }
    return complete;
  }

 private:
  using State = std::pair<std::uintmax_t, fs::file_time_type>;
  fs::path folder_;
  std::map<fs::path, std::pair<State, bool>> files_;
};

/// Calibration of the views so far.
class RunningCalibration {
 public:
  RunningCalibration(const WatchOptions& options, const Invocation& invocation)
      : options_(options), overwrite_(invocation.overwrite), detector_(options.board) {}

  void add(const fs::path& path) {
    const GreyImage image = read_grey(path);
    if (first_.pixels.empty()) first_ = image;
    require_same_size(first_, image, path);
    const std::string name = path.filename().string();
    if (detector_.add({.name = name}, image) == BoardFound::nothing)
      return Progress::report(name + ": no board");
    observations_ = BoardDetector(detector_).finish();
    Progress::report(fmt::format("{}: view {}", name, observations_.views.size()));
    update();
  }
  bool is_good() const { return is_good_; }
  const BoardObservations& observations() const { return observations_; }

 private:
  /// Few views, or views that are too alike, may not be enough yet.
  void update() {
    try {
      const RgbdCalibration calibration = calibrate(observations_, options_.calibration);
      write_calibration(options_.output, calibration, overwrite_);
      overwrite_ = true;
      is_good_ = calibration.details["verdict"] == "GOOD";
      report_state(calibration);
    } catch (const Error& error) {
      if (error.code() != ExitCode::data) throw;
      Progress::report(fmt::format("  {}", error.what()));
    }
  }
  void report_state(const RgbdCalibration& c) const {
    const double sigma_px = projection_sigma_quantile_px(c, judged_image_fraction);
    Progress::report(fmt::format(
        "  {}: {:.0f} % of the image covered, projection {}",
        c.details["verdict"].get<std::string>(), 1e2 * c.details["coverage"].get<double>(),
        std::isfinite(sigma_px) ? fmt::format("known to {:.2f} px", sigma_px) : "not yet known"));
    if (is_good_) return;
    if (const auto next = find_next_view(c, observations_.board))
      Progress::report(fmt::format("  next: {} (then {:.2f} px)", describe(*next), next->then_px));
  }

  const WatchOptions& options_;
  bool overwrite_, is_good_ = false;
  BoardDetector detector_;
  GreyImage first_;
  BoardObservations observations_;
};

}  // namespace

BoardObservations watch_folder(const WatchOptions& options, const Invocation& invocation) {
  if (!fs::is_directory(options.folder))
    throw data_error(fmt::format("{} is not a folder", options.folder),
                     "give --images FOLDER, in which --watch waits for images");
  RunningCalibration calibration(options, invocation);
  Progress::report(
      fmt::format("waiting for images in {}; Ctrl-C ends and leaves the last calibration in {}",
                  options.folder, options.output));
  FolderWatch folder(options.folder);
  while (!calibration.is_good()) {
    throw_if_interrupted();
    for (const auto& path : folder.new_images()) {
      if (calibration.is_good()) break;
      try {
        calibration.add(path);
      } catch (const Error& error) {
        if (error.code() != ExitCode::data) throw;
        Progress::report(fmt::format("{}: {}", path.filename().string(), error.what()));
      }
    }
    std::this_thread::sleep_for(polling_interval);
  }
  return calibration.observations();
}

}  // namespace touchtrace::cli
