#include "calib/rig/calibrate_rig.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/board/view_order.h"
#include "calib/matrix/product.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/robust_fit.h"
#include "calib/rig/rig_details.h"
#include "calib/rig/rig_start.h"
#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_robust_rounds = 3;

/// Adds the name of the camera to errors.
RgbdCalibration calibrate_alone(const RigInput& input, const CalibrationOptions& options) {
  try {
    return calibrate(input.observations, options);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("camera {}: {}", input.name, error.what()), error.hint());
  }
}

std::vector<bool> used_views(const RgbdCalibration& calibration) {
  std::vector<bool> used;
  for (const auto& view : calibration.details["views"]) used.push_back(view["used"].get<bool>());
  return used;
}

/// Variance of the corner offsets: the mean over the cameras that found them; 0 if none did.
double deformation_sigma_m(const std::vector<RgbdCalibration>& cameras) {
  double sum = 0.0, count = 0.0;
  for (const auto& camera : cameras) {
    const auto& deformation = camera.details["target_deformation"];
    if (deformation["chosen"] != "free") continue;
    sum += std::pow(deformation["sigma_m"].get<double>(), 2), count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

RigProblem make_rig_problem(const std::vector<RgbdCalibration>& cameras,
                            const std::vector<BoardObservations>& observations) {
  RigProblem problem{.observations = observations};
  std::vector<std::vector<bool>> used;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    used.push_back(used_views(cameras[i]));
    problem.priors.push_back(color_prior(observations[i], cameras[i].color.lens));
    problem.free.push_back(color_parameter_indices(cameras[i]));
    problem.corner_sigma_px.push_back(cameras[i].details["corner_sigma_px"].get<double>());
  }
  problem.frames = pair_frames(observations, used);
  problem.used.assign(problem.frames.size(), true);
  problem.deformation_sigma_m = deformation_sigma_m(cameras);
  return problem;
}

/// Estimates the board's pose in one frame with the rig fixed. Returns the RMS of its residuals
/// over the noise; infinite if that fails.
double fit_frame(RigProblem problem, RigParameters& p, std::size_t frame) {
  problem.used.assign(problem.frames.size(), false);
  problem.used[frame] = problem.fixed_rig = true;
  return solve(problem, p) ? rms(frame_residuals(problem, p, frame))
                           : std::numeric_limits<double>::infinity();
}

/// Uses the frames that are not outliers. Frames with one view do not count in the median: they
/// fit better.
void select_frames(RigProblem& problem, RigParameters& p) {
  std::vector<double> errors, of_pairs;
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame) {
    errors.push_back(fit_frame(problem, p, frame));
    if (problem.frames[frame].num_views() > 1) of_pairs.push_back(errors.back());
  }
  const double limit = outlier_ratio * median(std::move(of_pairs));
  for (std::size_t frame = 0; frame < errors.size(); ++frame)
    problem.used[frame] = std::isfinite(errors[frame]) && errors[frame] <= limit;
}

Error no_convergence() {
  return data_error("the calibration of the rig did not converge",
                    "check that the cameras are fixed to each other and that images of one number "
                    "were taken at the same time");
}

void fit_robustly(RigProblem& problem, RigParameters& p, const std::vector<std::string>& names) {
  for (int round = 0; round < num_robust_rounds; ++round) {
    throw_if_interrupted();
    select_frames(problem, p);
    require_connected(problem.frames, problem.used, names);
    if (!solve(problem, p)) throw no_convergence();
  }
}

ViewCovariance rig_covariance(const RigProblem& problem, const RigParameters& p,
                              const std::vector<std::string>& parameters) {
  const auto evaluation = evaluate(problem, p);
  if (!evaluation) throw no_convergence();
  const Eigen::MatrixXd left_rotations = left_rotation_jacobian(problem, p);
  const Eigen::MatrixXd marginal = marginal_covariance(
      eliminate_offsets(normal_equations(*evaluation)).parameters, left_rotations.rows());
  if (marginal.size() == 0) throw no_convergence();
  return view_covariance(*evaluation, parameters, left_rotations,
                         congruence(left_rotations, marginal));
}

}  // namespace

RigCalibration calibrate_rig(std::vector<RigInput> inputs, const CalibrationOptions& options) {
  if (inputs.size() < 2)
    throw usage_error("a rig has two or more cameras", "give --camera NAME=PATH for each");
  RigCalibration rig;
  std::vector<RgbdCalibration> alone;
  std::vector<BoardObservations> observations;
  for (RigInput& input : inputs) {
    align_symmetric_views(input.observations);
    alone.push_back(calibrate_alone(input, options));
    rig.names.push_back(input.name);
    observations.push_back(std::move(input.observations));
  }
  RigProblem problem = make_rig_problem(alone, observations);
  RigParameters p = rig_start(alone, rig.names, problem.frames, observations);
  fit_robustly(problem, p, rig.names);
  rig.parameters = rig_parameter_names(problem, p, rig.names);
  const ViewCovariance covariance = rig_covariance(problem, p, rig.parameters);
  std::vector<EpipolarError> epipolar;
  if (options.cross_validate) epipolar = held_out_epipolar_errors(problem, p);
  const RigSolution solution{problem, p, covariance, epipolar};
  for (std::size_t i = 0; i < alone.size(); ++i) {
    rig.cameras.push_back(joint_calibration(solution, i, alone[i]));
    rig.camera_from_rig.push_back(pose_of(p.cameras[i].camera_from_rig));
  }
  rig.covariance = covariance.by_views;
  rig.details = rig_details(solution, rig);
  return rig;
}

}  // namespace touchtrace
