#pragma once

#include <cstddef>
#include <vector>

namespace touchtrace {

// Helpers of the roll-out references. Arrays hold one block of equal size per step.

/// Block `t` of an array of blocks of `size`.
std::vector<double> step_of(const std::vector<double>& all, int t, std::size_t size);
void append(std::vector<double>& all, const std::vector<double>& part);
/// sum += part. An empty sum counts as zeros.
void add(std::vector<double>& sum, const std::vector<double>& part);

/// Appends the next states (last states + delta) and the spread softplus(band). `out`: [S, 2 state]
/// = delta | band, output of the last layer.
void append_prediction(const std::vector<double>& out, int state, std::vector<double>& states,
                       std::vector<double>& spread);
/// Scales the arrays from index `first` on to the magnitude and both signs of initial weights;
/// otherwise a roll-out would overflow float. The scale is a power of two, so that equal weights of
/// opposite sign cancel without rounding.
void scale_weights(std::vector<std::vector<double>>& arrays, std::size_t first, int hidden);

/// Gradient with respect to the last layer's output, from dl/ds(t+1) and the spread's gradient.
std::vector<double> output_gradient(int state, const std::vector<double>& carry,
                                    const std::vector<double>& grad_spread,
                                    const std::vector<double>& spread);

}  // namespace touchtrace
