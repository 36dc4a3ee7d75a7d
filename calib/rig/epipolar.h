#pragma once

#include <vector>

#include "calib/rig/rig_problem.h"

namespace touchtrace {

/// Distance of corners to the epipolar curves of two cameras, in frames that were excluded from the
/// fit.
struct EpipolarError {
  std::size_t first, second;  ///< cameras
  std::size_t num_frames;     ///< used frames that both see
  double rms_px;              ///< over both images; NaN if a fold does not converge
};

/// Cross-validates a solved rig with min(10, frames) folds over the used frames of two or more
/// views, for each pair of cameras that share a frame. The distance is |e| / |de/dpixel| of the
/// epipolar constraint e, evaluated in the distorted image: it holds for any lens, to first order.
std::vector<EpipolarError> held_out_epipolar_errors(const RigProblem& problem,
                                                    const RigParameters& solution);

}  // namespace touchtrace
