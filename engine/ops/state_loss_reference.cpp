#include "engine/ops/state_loss_reference.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

double sign(double x) { return (x > 0) - (x < 0); }
double pinball(double p, double tau) { return std::max(tau * p, -(1 - tau) * p); }
double pinball_slope(double p, double tau) { return p > 0 ? tau : p < 0 ? tau - 1 : tau - 0.5; }

}  // namespace

StateLoss state_loss_reference(double state, double spread, double target) {
  const double error = target - state;
  const double low = target - (state - spread), high = target - (state + spread);
  const double slope_low = pinball_slope(low, 0.1), slope_high = pinball_slope(high, 0.9);
  return {std::abs(error) + pinball(low, 0.1) + pinball(high, 0.9),
          -sign(error) - slope_low - slope_high, slope_low - slope_high};
}

}  // namespace touchtrace
