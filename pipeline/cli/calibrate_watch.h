#pragma once

#include <string>

#include "calib/board/board_view.h"
#include "calib/rgbd/calibrate.h"
#include "pipeline/cli/command.h"

namespace touchtrace::cli {

/// `touchtrace calibrate --images FOLDER --watch`
struct WatchOptions {
  std::string folder, output;
  CalibrationTarget board;
  CalibrationOptions calibration;
};

/// Looks for the board in each image that appears in the folder. After each view it writes the
/// calibration and prints, on stderr, its verdict and the next view that would help most. Returns
/// the views once the calibration is GOOD. Throws Error(ExitCode::interrupted) when interrupted;
/// the last calibration is in the output folder.
BoardObservations watch_folder(const WatchOptions& options, const Invocation& invocation);

}  // namespace touchtrace::cli
