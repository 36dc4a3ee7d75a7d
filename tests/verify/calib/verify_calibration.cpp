#include "tests/verify/calib/verify_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/cross_validation.h"
#include "calib/rgbd/statistics.h"
#include "tests/verify/calib/monte_carlo.h"

namespace touchtrace {
namespace {

constexpr int runs = 1000, views = 15, timed_runs = 20;
constexpr int compared_runs = 50;  ///< they are fitted ten times more
constexpr double print_sigma_m = 1e-4, print_noise_px = 0.1;
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

std::string at_noise(double corner_sigma_px) {
  return fmt::format("corner noise {} px", corner_sigma_px);
}

void emit_level(double corner_sigma_px, const std::function<void(Figure)>& emit) {
  const MonteCarlo result = monte_carlo(color_boards(corner_sigma_px), runs);
  const std::string at = at_noise(corner_sigma_px);
  const bool small = corner_sigma_px <= small_noise_px;
  emit(within("NEES/8 at " + at, result.color_nees, "", small ? 0.95 : 0.0, small ? 1.05 : 1.15));
  if (small) emit(at_most("worst RMSE over Cramer-Rao, " + at, worst_ratio(result), "", 1.1));
  emit(at_most("boards taken for badly printed, " + at, result.free_prints, "", 0.0));
}

/// The boards of the figures, their corners printed somewhere near where they should be.
SimulatedBoards misprinted_boards(RandomStream& random) {
  return misprinted(color_boards(print_noise_px), print_sigma_m, random);
}

void emit_print_against_ideal(const std::string& of, const std::function<void(Figure)>& emit) {
  double squares = 0.0, ideal_squares = 0.0, held_out = 0.0, ideal_held_out = 0.0;
  for (int run = 0; run < compared_runs; ++run) {
    RandomStream random(static_cast<std::uint64_t>(run), "compared prints");
    const SimulatedBoards boards = misprinted_boards(random);
    const BoardObservations o = observe(boards, random);
    const RgbdCalibration c = calibrate(o, {.lenses = {"radtan4"}, .cross_validate = true});
    const IdealBoard ideal = calibrate_with_ideal_board(o, {"radtan4"});
    squares += std::pow(c.color.fx - boards.truth.color[0], 2);
    ideal_squares += std::pow(ideal.fx - boards.truth.color[0], 2);
    held_out += std::pow(c.details["held_out"]["held_out_rms_px"].get<double>(), 2);
    ideal_held_out += std::pow(ideal.held_out_rms_px, 2);
  }
  emit(at_most("RMSE of fx over the ideal board's, " + of, std::sqrt(squares / ideal_squares), "",
               1.0));
  emit(at_most("held-out RMS over the ideal board's, " + of, std::sqrt(held_out / ideal_held_out),
               "", 1.0));
}

void emit_print(const std::function<void(Figure)>& emit) {
  const std::string of =
      fmt::format("corners printed {} mm off, {}", 1e3 * print_sigma_m, at_noise(print_noise_px));
  RandomStream random(1, "print");
  const MonteCarlo result = monte_carlo(misprinted_boards(random), runs);
  emit(within("NEES/8, " + of, result.color_nees, "", 0.95, 1.05));
  emit(at_most("worst RMSE over Cramer-Rao, " + of, worst_ratio(result), "", 1.1));
  emit(at_least("boards taken for badly printed, " + of, result.free_prints, "", runs));
  emit(reported("15 views, one lens, processor time, " + of, 1e3 * result.solve_seconds, "ms"));
  emit_print_against_ideal(of, emit);
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

IdealBoard calibrate_with_ideal_board(const BoardObservations& o,
                                      const std::vector<std::string>& lenses) {
  const ColorFit fit = fit_color(o, std::vector<bool>(o.views.size(), true), lenses);
  return {fit.parameters.color[0],
          cross_validate(color_problem(o, fit), fit.parameters).held_out_rms_px};
}

void verify_simulated_calibration(const std::function<void(Figure)>& emit) {
  for (double corner_sigma_px : {0.01, 0.1, 0.5, 2.0}) emit_level(corner_sigma_px, emit);
  emit_depth(emit);
  emit_print(emit);
  const MonteCarlo timing = monte_carlo(color_boards(0.2), timed_runs);
  emit(at_most("15 views, one lens, processor time", 1e3 * timing.solve_seconds, "ms", 50.0));
  emit(at_most("15 views, best of all lenses, processor time", choosing_ms(), "ms", 50.0));
}

}  // namespace touchtrace
