// Loss of the predicted states and its gradient (equation 4): L1 + pinball(Q) + pinball(1 - Q). The quantiles are
// state - spread and state + spread (equation 3); `quantile` is Q < 0.5.
//
//   pinball(tau) of residual p = max(tau p, (tau - 1) p); the slope at p = 0 is the mean of both one-sided slopes
//
// One work-item per row [step][sequence] of 16 values, of which STATE are used. weight: of the row, divided by the
// number of values that the mean is taken over. A row of weight 0 contributes nothing, even if its target is NaN.
//
// -D STATE: at most 16, no default

static real16 pinball(real16 p, real tau) { return fmax(tau * p, (tau - 1) * p); }
static real16 pinball_slope(real16 p, real tau) { return (tau - (real)0.5) + (real)0.5 * sign(p); }

__kernel void state_loss(__global const real* states, __global const real* spread,
                         __global const real* target, __global const real* weight, int sequences,
                         float quantile, __global real* loss, __global real* grad_state, __global real* grad_spread) {
  const size_t row = get_global_id(0);
  const real w = weight[row];
  real16 d = vload16(row, target) - vload16(row + sequences, states);
  real16 q = vload16(row, spread);
  if (w == 0) d = 0, q = 0;
  const real16 low = d + q, high = d - q;
  const real tau_low = quantile, tau_high = 1 - tau_low;
  const real16 value = fabs(d) + pinball(low, tau_low) + pinball(high, tau_high);
  const real16 slope_low = pinball_slope(low, tau_low), slope_high = pinball_slope(high, tau_high);

  real values[16], sum = 0;
  store16_private(value, 0, values);
  for (int i = 0; i < STATE; ++i) sum += values[i];
  loss[row] = w * sum;

  const real16 element = (real16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const real16 scale = select((real16)(0), (real16)(w), element < (real16)(STATE));
  store16(-scale * (sign(d) + slope_low + slope_high), row, grad_state);
  store16(scale * (slope_low - slope_high), row, grad_spread);
}
