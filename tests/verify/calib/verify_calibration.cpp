#include "tests/verify/calib/verify_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/cross_validation.h"
#include "engine/base/provenance.h"
#include "engine/base/statistics.h"
#include "tests/verify/calib/monte_carlo.h"
#include "tests/verify/calib/simulated_rig.h"

namespace touchtrace {
namespace {

constexpr int runs = 1000, views = 15, timed_runs = 20, rig_runs = 100;
constexpr int compared_runs = 50;  ///< each is fitted ten more times for cross-validation
constexpr double deformation_sigma_m = 1e-4, deformed_noise_px = 0.1;
constexpr double max_linear_noise_px = 0.5;  ///< up to here the problem is nearly linear

/// Camera of all figures, f about 610 px.
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
  const bool is_linear = corner_sigma_px <= max_linear_noise_px;
  emit(within("NEES/8 at " + at, result.color_nees, "", is_linear ? 0.95 : 0.0,
              is_linear ? 1.05 : 1.15));
  if (is_linear) emit(at_most("worst RMSE over Cramer-Rao, " + at, worst_ratio(result), "", 1.1));
  emit(at_most("boards found deformed, " + at, result.num_free_deformations, "", 0.0));
}

SimulatedBoards deformed_boards(RandomStream& random) {
  return with_deformed_target(color_boards(deformed_noise_px), deformation_sigma_m, random);
}

void compare_with_ideal_board(const std::string& of, const std::function<void(Figure)>& emit) {
  double squares = 0.0, ideal_squares = 0.0, held_out = 0.0, ideal_held_out = 0.0;
  for (int run = 0; run < compared_runs; ++run) {
    RandomStream random(static_cast<std::uint64_t>(run), "compared prints");
    const SimulatedBoards boards = deformed_boards(random);
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

void emit_deformation(const std::function<void(Figure)>& emit) {
  const std::string of =
      fmt::format("corners {} mm off, {}", 1e3 * deformation_sigma_m, at_noise(deformed_noise_px));
  RandomStream random(1, "print");
  const MonteCarlo result = monte_carlo(deformed_boards(random), runs);
  emit(within("NEES/8, " + of, result.color_nees, "", 0.95, 1.05));
  emit(at_most("worst RMSE over Cramer-Rao, " + of, worst_ratio(result), "", 1.1));
  emit(at_least("boards found deformed, " + of, result.num_free_deformations, "", runs));
  emit(reported("15 views, one lens, CPU time, " + of, 1e3 * result.cpu_s, "ms"));
  compare_with_ideal_board(of, emit);
}

void emit_depth(const std::function<void(Figure)>& emit) {
  const MonteCarlo result = monte_carlo(simulated_boards(views, true), runs);
  emit(within("NEES/22 with depth camera, corner noise 0.1 px", result.nees, "", 0.95, 1.05));
  for (std::size_t i = 0; i < result.names.size(); ++i)
    if (!result.names[i].starts_with("color."))
      emit(at_most("RMSE over Cramer-Rao, " + result.names[i], result.rmse_ratio[i], "", 1.1));
}

void emit_rig(const std::function<void(Figure)>& emit) {
  emit(within(fmt::format("NEES/6 of the relative pose of two cameras, {} rigs", rig_runs),
              rig_pose_nees(simulated_rig(views), rig_runs), "", 0.8, 1.25));
}

/// CPU time [ms] of one calibration that chooses among all lenses; median of `timed_runs`.
double lens_choice_cpu_ms() {
  std::vector<double> ms;
  for (int run = 0; run < timed_runs; ++run) {
    RandomStream random(static_cast<std::uint64_t>(run), "timed noise");
    const BoardObservations observed = observe(color_boards(0.2), random);
    const Stopwatch stopwatch;
    calibrate(observed);
    ms.push_back(1e3 * stopwatch.cpu_seconds());
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
  emit_deformation(emit);
  emit_rig(emit);
  const MonteCarlo timing = monte_carlo(color_boards(0.2), timed_runs);
  emit(at_most("15 views, one lens, CPU time", 1e3 * timing.cpu_s, "ms", 50.0));
  emit(at_most("15 views, best of all lenses, CPU time", lens_choice_cpu_ms(), "ms", 50.0));
}

}  // namespace touchtrace
