#include "calib/rgbd/verify_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <ctime>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/monte_carlo.h"
#include "calib/rgbd/statistics.h"

namespace touchtrace {
namespace {

constexpr int runs = 1000, views = 15, timed_runs = 20;
constexpr double small_noise_px = 0.5;  ///< up to here the bounds are those of a linear problem

/// The camera of the figures: f about 610 px.
SimulatedBoards color_boards(double corner_sigma_px) {
  SimulatedBoards boards = simulated_boards(views, false, 640);
  boards.corner_sigma_px = corner_sigma_px;
  return boards;
}

double worst_ratio(const MonteCarlo& result) {
  return *std::ranges::max_element(result.rmse_ratio);
}

void emit_level(double corner_sigma_px, const std::function<void(Figure)>& emit) {
  const MonteCarlo result = monte_carlo(color_boards(corner_sigma_px), runs);
  const std::string at = fmt::format("corner noise {} px", corner_sigma_px);
  const bool small = corner_sigma_px <= small_noise_px;
  emit(within("NEES/8 at " + at, result.color_nees, "", small ? 0.95 : 0.0, small ? 1.05 : 1.15));
  if (small) emit(at_most("worst RMSE over Cramer-Rao, " + at, worst_ratio(result), "", 1.1));
}

void emit_depth(const std::function<void(Figure)>& emit) {
  const MonteCarlo result = monte_carlo(simulated_boards(views, true), runs);
  emit(within("NEES/22 with depth camera, corner noise 0.1 px", result.nees, "", 0.95, 1.05));
  for (std::size_t i = 0; i < result.names.size(); ++i)
    if (!result.names[i].starts_with("color."))
      emit(at_most("RMSE over Cramer-Rao, " + result.names[i], result.rmse_ratio[i], "", 1.1));
}

/// Processor time [ms] of one calibration that chooses among all lenses; the median of a few.
double choosing_ms() {
  std::vector<double> ms;
  for (int run = 0; run < timed_runs; ++run) {
    RandomStream random(static_cast<std::uint64_t>(run), "timed noise");
    const BoardObservations observed = observe(color_boards(0.2), random);
    const std::clock_t start = std::clock();
    calibrate(observed);
    ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return median(std::move(ms));
}

}  // namespace

void verify_simulated_calibration(const std::function<void(Figure)>& emit) {
  for (double corner_sigma_px : {0.01, 0.1, 0.5, 2.0}) emit_level(corner_sigma_px, emit);
  emit_depth(emit);
  const MonteCarlo timing = monte_carlo(color_boards(0.2), timed_runs);
  emit(at_most("15 views, one lens, processor time", 1e3 * timing.solve_seconds, "ms", 50.0));
  emit(at_most("15 views, best of all lenses, processor time", choosing_ms(), "ms", 50.0));
}

}  // namespace touchtrace
