#pragma once

#include <vector>

namespace touchtrace {

/// Dense layer: out[rows, outputs] = in[rows, inputs] weight[outputs, inputs]' + bias[outputs].
struct DenseShape {
  int rows, inputs, outputs;
};

struct DenseGradients {
  std::vector<double> in, weight, bias;
};

/// Dense layer in plain loops. An empty `bias` counts as zero.
std::vector<double> dense_reference(const DenseShape& shape, const std::vector<double>& in,
                                    const std::vector<double>& weight,
                                    const std::vector<double>& bias);

DenseGradients dense_backward_reference(const DenseShape& shape, const std::vector<double>& in,
                                        const std::vector<double>& weight,
                                        const std::vector<double>& grad_out);

}  // namespace touchtrace
