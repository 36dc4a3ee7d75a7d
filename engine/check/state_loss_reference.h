#pragma once

#include <vector>

namespace touchtrace {

/// Of one prediction of one dimension, or summed over many.
struct StateLoss {
  double value = 0.0, grad_state = 0.0, grad_spread = 0.0;
};

/// L1 + pinball(Q) + pinball(1 - Q) (equations 3 and 4) for Q = `band_quantile`, its slopes the
/// mean of both sides at a kink.
StateLoss state_loss_reference(double state, double spread, double target, double band_quantile);

}  // namespace touchtrace
