#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// Configurations of a layer that are worth timing on a device, ten at most. The weight gradient
/// has its own launches, so the fastest of both lists combine.
struct Conv2dCandidates {
  std::vector<Conv2dChoice> products;   ///< for the forward pass and the input gradient
  std::vector<Conv2dChoice> gradients;  ///< for the weight gradient
};

Conv2dCandidates conv2d_candidates(const Runtime& runtime, const Conv2dShape& shape);

/// `products` with the weight-gradient members of `gradients`.
Conv2dChoice joined(Conv2dChoice products, const Conv2dChoice& gradients);

}  // namespace touchtrace
