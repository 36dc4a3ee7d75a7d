#include "calib/rgbd/calibrate.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "calib/board/view_order.h"
#include "calib/rgbd/board_models.h"
#include "calib/rgbd/board_motion.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/cross_validation.h"
#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/details.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/target_deformation.h"
#include "calib/rgbd/verdict.h"
#include "calib/rgbd/view_covariance.h"
#include "engine/base/error.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double first_extent = 0.5, final_extent = 1.0;  ///< as in depth_samples()
constexpr int num_joint_rounds = 4;
constexpr double same_view_px = 0.5;
constexpr std::size_t min_depth_samples = 100;

/// Size of the board, counted as --columns and --rows are.
std::string describe_size(const CalibrationTarget& board) {
  const TargetKind& kind = *board.kind;
  return fmt::format("{}x{} {}", board.columns / kind.element_corners,
                     board.rows / kind.element_corners, kind.element);
}

void require_views(const BoardObservations& o, std::ptrdiff_t views, const char* kind) {
  if (views >= min_views) return;
  const std::string skipped =
      o.skipped.empty() ? ""
                        : fmt::format("; {} images were skipped, the first: {}, {}",
                                      o.skipped.size(), o.skipped[0].name, o.skipped[0].why);
  throw data_error(
      fmt::format("only {} {} views of a board with {}; {} are needed{}", views, kind,
                  describe_size(o.board), min_views, skipped),
      "record 10 to 20 views with the whole board visible, tilted in different directions, and "
      "check --columns and --rows");
}

/// True if the corners have the orientation of a board seen from behind or in a mirror: no pose
/// fits them.
bool is_mirrored(const BoardView& view, const CalibrationTarget& board) {
  return image_scale_px_per_m({view.corners_px, view.corner_ids}, board).determinant() < 0.0;
}

void require_valid_views(const BoardObservations& o) {
  for (const auto& view : o.views) {
    if (!std::ranges::all_of(view.corners_px, [](const auto& c) { return c.allFinite(); }))
      throw data_error(fmt::format("{} has a corner that is not finite", view.name),
                       "remove this view");
    if (is_mirrored(view, o.board))
      throw data_error(fmt::format("{} shows the board from behind or in a mirror", view.name),
                       "remove this view, or turn mirroring off in the camera's driver");
  }
}

void require_proportions(const BoardObservations& o) {
  if (!o.board.kind->find_other_proportions) return;
  if (const auto other = o.board.kind->find_other_proportions(o.views, o.board))
    throw data_error("the images show " + other->seen, other->hint);
}

/// True if corners lie within `same_view_px` (RMS) of those of another view: the same image encoded
/// twice, or a video of a board and a camera at rest.
bool is_same_view(const BoardView& a, const BoardView& b) {
  if (a.corners_px.size() != b.corners_px.size() || a.corner_ids != b.corner_ids) return false;
  double squares = 0.0;
  for (std::size_t i = 0; i < a.corners_px.size(); ++i)
    squares += (a.corners_px[i] - b.corners_px[i]).squaredNorm();
  return squares <= same_view_px * same_view_px * static_cast<double>(a.corners_px.size());
}

/// [views] false for a duplicate of an earlier view, which would make the covariance too small.
std::vector<bool> different_views(const BoardObservations& o) {
  std::vector<bool> different(o.views.size(), true);
  for (std::size_t view = 0; view < o.views.size(); ++view)
    for (std::size_t before = 0; before < view && different[view]; ++before)
      different[view] = !different[before] || !is_same_view(o.views[view], o.views[before]);
  return different;
}

Error no_convergence() {
  return data_error("the calibration did not converge",
                    "use images of one camera and one board, and tilt the board more");
}

/// Estimates the depth camera with the colour camera fixed: first from the centre of the board,
/// because the baseline of the cameras is unknown, then from all of it. Returns false if too few
/// depth pixels are on the board.
bool initialize_depth_camera(BoardProblem& problem, RgbdParameters& p) {
  problem.estimated = Estimated::depth_camera;
  for (double extent : {first_extent, final_extent}) {
    problem.samples = depth_samples(problem.observations, problem.used, p, extent);
    if (problem.samples.size() < min_depth_samples || !solve(problem, p))
      return problem.samples.clear(), false;
  }
  problem.samples = depth_samples(problem.observations, problem.used, p, final_extent);
  problem.estimated = Estimated::everything;
  return true;
}

/// Solves for all parameters; each round takes its weights from the residuals of the last one.
bool solve_jointly(BoardProblem& problem, RgbdParameters& p, DepthNoise& noise) {
  for (int round = 0; round < num_joint_rounds; ++round) {
    throw_if_interrupted();
    noise = reweight_samples(problem.samples, p, round > 0);
    if (!solve(problem, p)) return false;
    problem.corner_sigma_px = estimate_corner_sigma_px(problem, p);
  }
  return true;
}

double depth_rms_m(const std::vector<DepthSample>& samples, const RgbdParameters& p) {
  double squares = 0.0;
  for (const auto& sample : samples) squares += std::pow(depth_residual(sample, p), 2);
  return samples.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(samples.size()));
}

Camera depth_camera(const BoardObservations& o, const std::array<double, 4>& intrinsics) {
  Camera camera{.width = o.width, .height = o.height};
  camera.set_parameters({intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]});
  return camera;
}

RgbdCalibration assemble_calibration(const BoardProblem& problem, const RgbdParameters& p,
                                     const Eigen::MatrixXd& covariance) {
  RgbdCalibration c;
  c.color = color_camera(problem.observations, p);
  if (!problem.samples.empty()) c.depth = depth_camera(problem.observations, p.depth);
  c.depth_from_color = pose_of(p.depth_from_color);
  c.depth_scale = p.depth_correction[0], c.depth_offset_m = p.depth_correction[1];
  c.depth_delay_s = p.depth_delay_s;
  c.board_warp_m = p.board_warp_m;
  c.lit = problem.observations.lit;
  c.rms_px = rms_of_used_views(problem.observations, problem.used, p);
  c.depth_rms_m = depth_rms_m(problem.samples, p);
  c.parameters = parameter_names(problem, p.lens);
  c.covariance = covariance;
  return c;
}

/// Solution for the colour camera and the board.
struct BoardFit {
  BoardProblem problem;
  RgbdParameters parameters;
  BoardModels models;
};

BoardFit fit_board_with_lens(const BoardObservations& observations, const ColorFit& color,
                             const CalibrationOptions& options) {
  BoardFit fit{color_problem(observations, color), color.parameters, {}};
  fit.models = fit_board(fit.problem, fit.parameters, options.target_deformation);
  return fit;
}

/// Fits the board's deformation, with which the lens of `color` is chosen again.
BoardFit fit_color_and_board(const BoardObservations& observations, ColorFit& color,
                             const CalibrationOptions& options) {
  const BoardFit fit = fit_board_with_lens(observations, color, options);
  if (!fit.models.free_corners || color.trials.size() < 2 ||
      !choose_lens_again(fit.problem, fit.parameters, color))
    return fit;
  if (!color.converged) throw no_convergence();
  return fit_board_with_lens(observations, color, options);
}

}  // namespace

RgbdCalibration calibrate(BoardObservations observations, const CalibrationOptions& options) {
  const auto wall_start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  require_views(observations, static_cast<std::ptrdiff_t>(observations.views.size()), "detected");
  require_valid_views(observations);
  require_proportions(observations);
  align_symmetric_views(observations);
  const auto different = different_views(observations);
  require_views(observations, std::ranges::count(different, true), "different");
  ColorFit color = fit_color(observations, different, options.lenses);
  if (!color.converged) throw no_convergence();
  require_views(observations, std::ranges::count(color.used, true), "usable");
  auto [problem, parameters, boards] = fit_color_and_board(observations, color, options);
  add_depth_prior(observations, parameters, problem.prior);
  parameters.depth = problem.prior.depth_mean;
  problem.free_delay = is_delay_observable(board_motions(observations, color.used, parameters));
  DepthNoise noise;
  if (has_depth(observations) && initialize_depth_camera(problem, parameters) &&
      !solve_jointly(problem, parameters, noise))
    throw no_convergence();
  const Eigen::MatrixXd independent = covariance_of_estimate(problem, parameters);
  if (independent.size() == 0) throw no_convergence();
  const ViewCovariance covariance = view_covariance(problem, parameters, independent);
  RgbdCalibration calibration = assemble_calibration(problem, parameters, covariance.by_views);
  calibration.details = calibration_details(
      {problem, parameters, calibration, covariance, color, noise, different, boards});
  const std::chrono::duration<double> wall_s = std::chrono::steady_clock::now() - wall_start;
  calibration.details["solving"] = {
      {"wall_s", wall_s.count()},
      {"cpu_s", static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC}};
  if (options.cross_validate)
    calibration.details["held_out"] = held_out_json(cross_validate(problem, parameters));
  return calibration;
}

}  // namespace touchtrace
