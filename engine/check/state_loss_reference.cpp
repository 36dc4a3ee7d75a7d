#include "engine/check/state_loss_reference.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

double sign(double x) { return (x > 0) - (x < 0); }
double pinball(double p, double tau) { return std::max(tau * p, -(1 - tau) * p); }
double pinball_slope(double p, double tau) { return p > 0 ? tau : p < 0 ? tau - 1 : tau - 0.5; }

}  // namespace

StateLoss state_loss_reference(double state, double spread, double target, double band_quantile) {
  const double error = target - state;
  const double low = target - (state - spread), high = target - (state + spread);
  const double tau_low = band_quantile, tau_high = 1 - band_quantile;
  const double slope_low = pinball_slope(low, tau_low), slope_high = pinball_slope(high, tau_high);
  return {std::abs(error) + pinball(low, tau_low) + pinball(high, tau_high),
          -sign(error) - slope_low - slope_high, slope_low - slope_high};
}

}  // namespace touchtrace
