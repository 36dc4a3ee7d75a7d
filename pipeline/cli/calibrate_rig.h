#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board/board_view.h"
#include "calib/rgbd/calibrate.h"
#include "pipeline/cli/command.h"

namespace touchtrace::cli {

/// `touchtrace calibrate --camera NAME=PATH...`
struct RigOptions {
  std::vector<std::string> cameras;  ///< NAME=PATH, or PATH with the name of its last folder
  CalibrationTarget board;
  CalibrationOptions calibration;
  std::string output;
};

/// Images of all cameras, NAME=PATH as in RigOptions.
std::vector<std::filesystem::path> images_of_rig(const std::vector<std::string>& cameras);

/// Whether a path is a folder or rig.json of a calibrated rig.
bool is_rig(const std::string& path);

/// `touchtrace calibrate --compare A B` of two rigs.
ExitCode compare_rigs(const std::string& a, const std::string& b, bool as_json);

ExitCode calibrate_rig(const RigOptions& options, const Invocation& invocation);

}  // namespace touchtrace::cli
