#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/lens_choice.h"

namespace touchtrace {

/// Differences of BIC that are positive and very strong evidence (Kass and Raftery, JASA 1995).
inline constexpr double bic_positive_evidence = 2.0, bic_very_strong_evidence = 10.0;

/// Fit of one candidate lens.
struct LensTrial {
  std::string name;  ///< lens_name(); "none": no radial coefficients
  /// Unobservable coefficients, fixed at 0, and the reason.
  std::vector<std::pair<std::string, std::string>> removed;
  RgbdParameters parameters;
  std::vector<int> free_color;  ///< as BoardProblem::free_color
  /// Squared residuals [px^2] of corners and their offsets, per coordinate; infinite: no fit.
  double mean_square = std::numeric_limits<double>::infinity();
  double bic = 0.0;  ///< relative to the chosen lens; infinite: no fit

  bool converged() const;
};

/// Candidate lens and the parameters from which its fit starts.
struct LensStart {
  LensChoice choice;
  RgbdParameters parameters;
};

/// Fits lenses to the used views of `problem`. Its prior of the corner offsets holds for all; the
/// rest of the prior and the free coefficients are the lens's. Unobservable coefficients are
/// removed, the last first, and the remaining ones fitted again.
std::vector<LensTrial> fit_lenses(BoardProblem problem, const std::vector<LensStart>& starts);

/// Input of the choice other than the fits.
struct LensRule {
  double count;  ///< of independent residuals
  /// Whether the lens that is best for independent corners determines most of the image.
  bool image_known = true;
};

/// Chooses by the Bayesian information criterion and stores it in the trials, relative to the
/// chosen one. A later lens must be better by 2, one of the other ideal projection (perspective,
/// fisheye) by 10, unless it has fewer coefficients and the image is not known. Returns an index;
/// nullopt if no fit converged.
std::optional<std::size_t> choose_lens(std::vector<LensTrial>& trials, const LensRule& rule);

/// Makes LensTrial::bic relative to that of one of the trials.
void make_bic_relative(std::vector<LensTrial>& trials, std::size_t chosen);

}  // namespace touchtrace
