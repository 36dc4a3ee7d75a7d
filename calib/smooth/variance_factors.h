#pragma once

#include <array>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// Scale factors of smoothed covariances: mean squares of studentised residuals (variance of unit
/// weight; Baarda 1968), one per phase. 1 if the noise model is correct. Between frames a hand
/// moves more smoothly than the noise on jerk that predicts the next frame best, so its factor is
/// below 1. Before a throw it is not: pushes of a few milliseconds may leave no trace in a
/// residual, so no covariance is reduced there. In flight, at its ends and shortly after it the
/// factor is 1.
class VarianceFactors {
 public:
  /// Adds the residuals of `track`, whose smoothed motion is `trajectory`. `expected_mean_square`:
  /// their mean square if the noise model is correct.
  void add(const WeightedTrack& track, const Trajectory& trajectory, double expected_mean_square);
  void add(const VarianceFactors& other);

  /// Factor at a time of a motion with these flights.
  double at(const std::vector<Flight>& flights, double time_s) const;

 private:
  struct Residuals {
    double sum_of_squares = 0.0, count = 0.0;
    double mean_or_1() const;
  };
  std::array<Residuals, 2> phases_;  ///< contact, before a throw
};

}  // namespace touchtrace
