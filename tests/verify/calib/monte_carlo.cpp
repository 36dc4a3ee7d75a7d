#include "tests/verify/calib/monte_carlo.h"

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

struct Run {
  Eigen::VectorXd error;
  double color_nees = 0.0, nees = 0.0, seconds = 0.0;
  bool free_print = false;
  std::vector<std::string> names;
};

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double normalized_square(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

/// Tangential distortion, the board's warp and its print are others each time, as the prior has
/// them: a covariance with a prior is true on average over what the prior allows.
SimulatedBoards as_the_prior_has_it(const SimulatedBoards& boards, RandomStream& random) {
  std::array<double, max_coefficients> lens;
  std::copy_n(boards.truth.color.begin() + 4, max_coefficients, lens.begin());
  if (is_perspective(boards.truth.lens))
    for (int i : {2, 3}) lens[static_cast<std::size_t>(i)] = random.normal(0.0, tangential_sigma);
  const double warp_m = warp_sigma_m(boards.clean.board);
  SimulatedBoards other = boards;
  if (boards.clean.views.front().depth_m.empty())
    other.truth.board_warp_m = {random.normal(0.0, warp_m), random.normal(0.0, warp_m)};
  if (boards.print_sigma_m > 0.0)
    other = misprinted(std::move(other), boards.print_sigma_m, random);
  return seen_through(std::move(other), boards.truth.lens, lens);
}

Run run_once(const SimulatedBoards& all, int index) {
  RandomStream random(static_cast<std::uint64_t>(index), "simulated noise");
  const SimulatedBoards boards = as_the_prior_has_it(all, random);
  const BoardObservations observations = observe(boards, random);
  const double start_s = thread_seconds();
  const RgbdCalibration c = calibrate(observations, {.lenses = {lens_name(boards.truth.lens)}});
  Run run;
  run.seconds = thread_seconds() - start_s;
  run.free_print = c.details["board_print"]["chosen"] == "free";
  run.names = c.parameters;
  run.error = errors(c, boards.truth);
  run.nees = normalized_square(run.error, c.covariance);
  const auto color_parameters =
      static_cast<Eigen::Index>(intrinsic_names(boards.truth.lens).size());
  run.color_nees =
      normalized_square(run.error.head(color_parameters),
                        c.covariance.topLeftCorner(color_parameters, color_parameters));
  return run;
}

std::vector<Run> run_all(const SimulatedBoards& boards, int count) {
  std::vector<Run> runs(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::mutex mutex;
  std::exception_ptr failed;
  Progress progress("simulated calibrations", static_cast<std::uint64_t>(count));
  const auto work = [&] {
    try {
      for (int i = next++; i < count; i = next++) {
        runs[static_cast<std::size_t>(i)] = run_once(boards, i);
        progress.advance();
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failed = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
      threads.emplace_back(work);
  }
  if (failed) std::rethrow_exception(failed);
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
      throw failure("the data do not tell a parameter of the simulated lens",
                    "simulate less noise");
    squares += run.error.cwiseAbs2() / count;
    result.free_prints += run.free_print;
    result.nees += run.nees / count;
    result.color_nees += run.color_nees / count;
    result.solve_seconds += run.seconds / count;
  }
  const Eigen::VectorXd ratios = (squares.array() / bound.diagonal().array()).sqrt();
  result.rmse_ratio.assign(ratios.begin(), ratios.end());
  return result;
}

}  // namespace touchtrace
