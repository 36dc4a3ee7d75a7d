#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// Gradients of a convolution with respect to its three inputs.
struct Conv2dGradients {
  std::vector<double> in, weight, bias;
};

/// Convolution of conv2d.h in plain loops. Arrays in C order without halo: in [image, channel, row,
/// column], weight [out, in, kernel, kernel], bias [out].
std::vector<double> conv2d_reference(const Conv2dShape& shape, const std::vector<double>& in,
                                     const std::vector<double>& weight,
                                     const std::vector<double>& bias);

/// The pre-activation.
std::vector<double> conv2d_sum_reference(const Conv2dShape& shape, const std::vector<double>& in,
                                         const std::vector<double>& weight,
                                         const std::vector<double>& bias);

/// `grad_sum`: gradient with respect to the pre-activation.
Conv2dGradients conv2d_backward_reference(const Conv2dShape& shape, const std::vector<double>& in,
                                          const std::vector<double>& weight,
                                          const std::vector<double>& grad_sum);

}  // namespace touchtrace
