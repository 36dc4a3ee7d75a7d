#include "calib/rgbd/calibrate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/details.h"
#include "calib/rgbd/verdict.h"
#include "engine/base/error.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double centre_sigma =
    0.1;  ///< of the principal point about the image's centre, of the width
constexpr double factory_sigma =
    0.005;  ///< of factory depth intrinsics, relative; centre: of the width
constexpr double guessed_sigma = 0.1;  ///< of depth intrinsics taken from the colour camera
constexpr double pose_sigma_rad = 0.1,
                 pose_sigma_m = 0.1;  ///< of the depth camera beside the colour one
constexpr double scale_sigma = 0.05, offset_sigma_m = 0.05;  ///< of the depth's error
constexpr double first_extent = 0.5, final_extent = 1.0;  ///< of the board that depth is taken from
constexpr int joint_rounds = 2;
constexpr std::size_t fewest_samples = 100;

Prior color_prior(const BoardObservations& o) {
  Prior prior;
  prior.color_sigma.fill(infinity);
  prior.color_mean[2] = 0.5 * (o.width - 1), prior.color_mean[3] = 0.5 * (o.height - 1);
  prior.color_sigma[2] = prior.color_sigma[3] = centre_sigma * o.width;
  return prior;
}

void add_depth_prior(const BoardObservations& o, const RgbdParameters& p, Prior& prior) {
  const bool known = o.depth_intrinsics[0] > 0.0;
  const double relative = known ? factory_sigma : guessed_sigma;
  if (known) prior.depth_mean = o.depth_intrinsics;
  if (!known) std::copy_n(p.color.begin(), 4, prior.depth_mean.begin());
  prior.depth_sigma = {relative * prior.depth_mean[0], relative * prior.depth_mean[1],
                       relative * o.width, relative * o.width};
  prior.pose_sigma = {pose_sigma_rad, pose_sigma_rad, pose_sigma_rad,
                      pose_sigma_m,   pose_sigma_m,   pose_sigma_m};
  prior.correction_sigma = {scale_sigma, offset_sigma_m};
}

void require_views(const BoardObservations& o, std::ptrdiff_t views, const char* what) {
  if (views < fewest_views)
    throw data_error(
        fmt::format("the board of {}x{} inner corners was {} in {} views; {} are needed",
                    o.board.columns, o.board.rows, what, views, fewest_views),
        "record 10 to 20 views with the whole board visible, tilted in different directions, and "
        "check --columns and --rows");
}

Error no_convergence() {
  return data_error(
      "the calibration did not converge",
      "check that all images are of one camera and one board, and tilt the board more");
}

/// The depth camera placed by itself, first from the middle of the board because the cameras'
/// distance is unknown, then from all of it. False if there is too little depth on the board.
bool place_depth_camera(BoardProblem& problem, RgbdParameters& p) {
  problem.depth_only = true;
  for (double extent : {first_extent, final_extent}) {
    problem.samples = depth_samples(problem.observations, problem.used, p, extent);
    if (problem.samples.size() < fewest_samples || !solve(problem, p))
      return problem.samples.clear(), false;
  }
  problem.samples = depth_samples(problem.observations, problem.used, p, final_extent);
  problem.depth_only = false;
  return true;
}

/// Everything together; each round weighs by the noise that the one before left.
bool solve_jointly(BoardProblem& problem, RgbdParameters& p, DepthNoise& noise) {
  for (int round = 0; round < joint_rounds; ++round) {
    throw_if_interrupted();
    noise = weigh_samples(problem.samples, p);
    if (!solve(problem, p)) return false;
    problem.corner_sigma_px =
        corner_noise_px(problem.observations, problem.used, problem.free_color.size(), p);
  }
  return true;
}

double rms_of_used(const BoardProblem& problem, const RgbdParameters& p) {
  std::vector<Eigen::Vector2d> all;
  for (std::size_t view = 0; view < problem.used.size(); ++view)
    if (problem.used[view])
      for (const auto& residual : corner_residuals(problem.observations, view, p))
        all.push_back(residual);
  return rms(all);
}

double depth_rms_m(const std::vector<DepthSample>& samples, const RgbdParameters& p) {
  double squares = 0.0;
  for (const auto& sample : samples) squares += std::pow(depth_residual(sample, p), 2);
  return samples.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(samples.size()));
}

PinholeCamera depth_camera(const BoardObservations& o, const std::array<double, 4>& intrinsics) {
  PinholeCamera camera{.width = o.width, .height = o.height};
  camera.set_parameters({intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]});
  return camera;
}

RgbdCalibration calibration_of(const BoardProblem& problem, const RgbdParameters& p) {
  RgbdCalibration c;
  c.color.width = problem.observations.width, c.color.height = problem.observations.height;
  c.color.set_parameters(p.color);
  if (!problem.samples.empty()) c.depth = depth_camera(problem.observations, p.depth);
  c.depth_from_color = pose_of(p.depth_from_color);
  c.depth_scale = p.depth_correction[0], c.depth_offset_m = p.depth_correction[1];
  c.rms_px = rms_of_used(problem, p);
  c.depth_rms_m = depth_rms_m(problem.samples, p);
  c.parameters = parameter_names(problem);
  c.covariance = covariance(problem, p);
  if (c.covariance.size() == 0) throw no_convergence();
  return c;
}

}  // namespace

RgbdCalibration calibrate(const BoardObservations& observations) {
  require_views(observations, static_cast<std::ptrdiff_t>(observations.views.size()), "found");
  BoardProblem problem{observations, {}, {}, color_prior(observations)};
  const ColorFit color = fit_color(observations, problem.prior);
  if (!color.converged) throw no_convergence();
  require_views(observations, std::ranges::count(color.used, true), "usable");
  RgbdParameters parameters = color.parameters;
  problem.used = color.used;
  problem.free_color = color.free_color;
  problem.corner_sigma_px = color.corner_sigma_px;
  add_depth_prior(observations, parameters, problem.prior);
  parameters.depth = problem.prior.depth_mean;
  DepthNoise noise;
  if (has_depth(observations) && place_depth_camera(problem, parameters) &&
      !solve_jointly(problem, parameters, noise))
    throw no_convergence();
  RgbdCalibration calibration = calibration_of(problem, parameters);
  calibration.details = calibration_details({problem, parameters, calibration, color, noise});
  return calibration;
}

}  // namespace touchtrace
