#pragma once

#include <vector>

namespace touchtrace {

struct LayerNormGradients {
  std::vector<double> x, gain, bias;
};

/// LayerNorm in plain loops: x [rows, columns], gain and bias [columns].
std::vector<double> layer_norm_reference(const std::vector<double>& x,
                                         const std::vector<double>& gain,
                                         const std::vector<double>& bias);

LayerNormGradients layer_norm_backward_reference(const std::vector<double>& x,
                                                 const std::vector<double>& gain,
                                                 const std::vector<double>& grad_y);

}  // namespace touchtrace
