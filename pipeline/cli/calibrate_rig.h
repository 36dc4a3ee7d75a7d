#pragma once

#include <string>
#include <vector>

#include "calib/board/chessboard.h"
#include "calib/rgbd/calibrate.h"
#include "pipeline/cli/command.h"

namespace touchtrace::cli {

/// `touchtrace calibrate --camera NAME=PATH...`
struct RigOptions {
  std::vector<std::string> cameras;  ///< NAME=PATH, or PATH with the name of its last folder
  Chessboard board;
  CalibrationOptions calibration;
  std::string output;
};

ExitCode calibrate_rig(const RigOptions& options, const Invocation& invocation);

}  // namespace touchtrace::cli
