#pragma once

#include <array>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// How a body moves, as far as it matters to how true covariances are.
enum class Phase {
  settled,    ///< in touch, and not about to be thrown
  winding_up  ///< about to be thrown
};

/// By how much smoothed covariances are too large or too small: the mean square of studentised
/// residuals (the variance of unit weight; Baarda 1968), of each phase its own. It is 1 if noise is
/// what it is taken for. A hand moves more smoothly between frames than noise on jerk does that
/// foretells the next frame best, and before a throw less so: there are pushes of a few
/// milliseconds, and as they may leave no trace in a residual, no covariance is made smaller there.
/// In flight, at its ends and shortly after them covariances stay as they are.
class VarianceFactors {
 public:
  /// `trajectory`: of `track`; `usual`: the mean square where noise is what it is taken for.
  void add(const WeightedTrack& track, const Trajectory& trajectory, double usual);
  void add(const VarianceFactors& others);

  /// Of a motion with such flights.
  double at(const std::vector<Flight>& flights, double time_s) const;

 private:
  struct Residuals {
    double squares = 0.0, count = 0.0;
    double mean_or_1() const;
  };
  std::array<Residuals, 2> phases_;
};

}  // namespace touchtrace
