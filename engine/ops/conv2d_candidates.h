#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// What is worth measuring for a layer on a device, ten choices at most. The launches of the
/// weights' gradient are apart from all others, so the best of both kinds add up.
struct Conv2dCandidates {
  std::vector<Conv2dChoice> products;   ///< differ in the forward pass and the input's gradient
  std::vector<Conv2dChoice> gradients;  ///< differ in the weights' gradient
};

Conv2dCandidates conv2d_candidates(const Runtime& runtime, const Conv2dShape& shape);

/// `products` with the weights' gradient of `gradients`.
Conv2dChoice joined(Conv2dChoice products, const Conv2dChoice& gradients);

}  // namespace touchtrace
