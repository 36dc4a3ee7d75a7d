#pragma once

#include <cstddef>
#include <vector>

namespace touchtrace {

// What the references of roll-outs share. Arrays hold equal parts a step, one after the other.

/// Step `t` of an array of parts of `size`.
std::vector<double> step_of(const std::vector<double>& all, int t, std::size_t size);
void append(std::vector<double>& all, const std::vector<double>& part);
/// sum += part; an empty sum counts as zeros.
void add(std::vector<double>& sum, const std::vector<double>& part);

/// Appends the next states, and the spread softplus(band), from the last layer's [S, 2 state] =
/// delta | band.
void append_prediction(const std::vector<double>& out, int state, std::vector<double>& states,
                       std::vector<double>& spread);
/// Gives the arrays from number `first` on, which are weights, the size and both signs that a
/// network starts with, or a roll-out would leave the range of float. A power of two, so that
/// weights of one size cancel without rounding.
void scale_weights(std::vector<std::vector<double>>& arrays, std::size_t first, int hidden);

/// Towards the last layer's output, from dl/ds(t+1) and the gradient towards the spread.
std::vector<double> output_gradient(int state, const std::vector<double>& carry,
                                    const std::vector<double>& grad_spread,
                                    const std::vector<double>& spread);

}  // namespace touchtrace
