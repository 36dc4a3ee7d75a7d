#pragma once

#include "calib/rgbd/view_covariance.h"
#include "calib/rig/epipolar.h"
#include "calib/rig/rig.h"

namespace touchtrace {

struct RigSolution {
  const RigProblem& problem;
  const RigParameters& parameters;
  const ViewCovariance& covariance;  ///< of rig_parameter_names()
  const std::vector<EpipolarError>& epipolar;
};

/// RigCalibration::details.
///     verdict, advice   as in calibration.json; advice begins with the name of the camera
///     relative_poses    [{camera, baseline_m, baseline_sigma_m, rotation_rad,
///                       rotation_sigma_rad}..] to the first camera
///     sigmas            {parameter: standard deviation}
///     frame_inflation   ViewCovariance::inflation
///     epipolar          [{cameras [a, b], rms_px in held-out frames, frames}..], with
///                       CalibrationOptions::cross_validate; null: no convergence
///     frames            [{name, used, images {camera: file}, rms_sigmas}..]; rms_sigmas: RMS
///                       of the residuals over the noise of a corner
///     outlier_frames    [name..]
nlohmann::json rig_details(const RigSolution& solution, const RigCalibration& rig);

/// The calibration of one camera with the intrinsics, covariance and residuals of the rig. `alone`:
/// its result of calibrate(), which the lens choice and the held-out error are taken from.
RgbdCalibration joint_calibration(const RigSolution& solution, std::size_t camera,
                                  const RgbdCalibration& alone);

}  // namespace touchtrace
