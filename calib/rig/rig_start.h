#pragma once

#include "calib/rgbd/calibration.h"
#include "calib/rig/rig_problem.h"

namespace touchtrace {

/// Start for a rig: intrinsics of the calibrated cameras, poses from single views.
///
/// The relative pose of two cameras is that of the shared frame with the smallest median transfer
/// error over all their shared frames, so that fewer than half of the frames may be wrong pairs.
/// Cameras are chained along their most shared frames. Reverses the corners of views of a symmetric
/// board that another camera of the frame sees turned by 180 degrees. Throws data_error if a camera
/// shares fewer than three frames with the others.
RigParameters rig_start(const std::vector<RgbdCalibration>& cameras,
                        const std::vector<std::string>& names, const std::vector<RigFrame>& frames,
                        std::vector<BoardObservations>& observations);

/// Throws data_error unless the used frames connect all cameras, by three or more between two.
void require_connected(const std::vector<RigFrame>& frames, const std::vector<bool>& used,
                       const std::vector<std::string>& names);

}  // namespace touchtrace
