#include "tests/verify/calib/monte_carlo.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "tests/verify/support/thread_clock.h"

namespace touchtrace {
namespace {

struct Run {
  Eigen::VectorXd error;
  double color_nees = 0.0, nees = 0.0, cpu_s = 0.0;
  bool has_free_deformation = false;
  std::vector<std::string> names;
};

double normalized_square(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

/// Draws tangential distortion, warp and deformation from their priors: a posterior covariance is
/// consistent on average over the prior.
SimulatedBoards draw_from_prior(const SimulatedBoards& boards, RandomStream& random) {
  std::array<double, max_coefficients> lens;
  std::copy_n(boards.truth.color.begin() + 4, max_coefficients, lens.begin());
  if (is_perspective(boards.truth.lens))
    for (int i : {2, 3}) lens[static_cast<std::size_t>(i)] = random.normal(0.0, tangential_sigma);
  const double warp_m = warp_sigma_m(boards.clean.board);
  SimulatedBoards other = boards;
  if (boards.clean.views.front().depth_m.empty())
    other.truth.board_warp_m = {random.normal(0.0, warp_m), random.normal(0.0, warp_m)};
  if (boards.deformation_sigma_m > 0.0)
    other = with_deformed_target(std::move(other), boards.deformation_sigma_m, random);
  return with_lens_coefficients(std::move(other), boards.truth.lens, lens);
}

Run run_once(const SimulatedBoards& all, int index) {
  RandomStream random(static_cast<std::uint64_t>(index), "simulated noise");
  const SimulatedBoards boards = draw_from_prior(all, random);
  const BoardObservations observations = observe(boards, random);
  const double start_s = thread_cpu_seconds();
  const RgbdCalibration c =
      calibrate(observations, {.lenses = {lens_name(fitted_lens(boards).named)}});
  Run run;
  run.cpu_s = thread_cpu_seconds() - start_s;
  run.has_free_deformation = c.details["target_deformation"]["chosen"] == "free";
  run.names = c.parameters;
  run.error = errors(c, boards.truth);
  run.nees = normalized_square(run.error, c.covariance);
  const auto color_parameters = static_cast<Eigen::Index>(fitted_lens(boards).free_color.size());
  run.color_nees =
      normalized_square(run.error.head(color_parameters),
                        c.covariance.topLeftCorner(color_parameters, color_parameters));
  return run;
}

std::vector<Run> run_all(const SimulatedBoards& boards, int count) {
  std::vector<Run> runs(static_cast<std::size_t>(count));
  Progress progress("simulated calibrations", static_cast<std::uint64_t>(count));
  parallel_for(runs.size(), 0, [&](std::size_t i) {
    runs[i] = run_once(boards, static_cast<int>(i));
    progress.advance();
  });
  return runs;
}

}  // namespace

MonteCarlo monte_carlo(const SimulatedBoards& boards, int count) {
  const auto runs = run_all(boards, count);
  MonteCarlo result;
  result.runs = count;
  result.names = runs.front().names;
  const Eigen::MatrixXd bound = cramer_rao_bound(boards);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(runs.front().error.size());
  for (const auto& run : runs) {
    if (run.error.size() != bound.rows())
      throw failure("a coefficient of the simulated lens is unobservable in a run",
                    "simulate less noise");
    squares += run.error.cwiseAbs2() / count;
    result.num_free_deformations += run.has_free_deformation;
    result.nees += run.nees / count;
    result.color_nees += run.color_nees / count;
    result.cpu_s += run.cpu_s / count;
  }
  const Eigen::VectorXd ratios = (squares.array() / bound.diagonal().array()).sqrt();
  result.rmse_ratio.assign(ratios.begin(), ratios.end());
  return result;
}

}  // namespace touchtrace
