#include "engine/check/layer_norm_reference.h"

#include <cmath>
#include <cstddef>

namespace touchtrace {
namespace {

/// Mean and standard deviation of one row.
struct Statistics {
  double mean = 0.0, deviation = 0.0;
};

Statistics statistics(const std::vector<double>& x, std::size_t begin, std::size_t columns) {
  Statistics s;
  for (std::size_t i = begin; i < begin + columns; ++i) s.mean += x[i] / columns;
  double variance = 0.0;
  for (std::size_t i = begin; i < begin + columns; ++i)
    variance += (x[i] - s.mean) * (x[i] - s.mean) / columns;
  s.deviation = std::sqrt(variance + 1e-5);
  return s;
}

}  // namespace

std::vector<double> layer_norm_reference(const std::vector<double>& x,
                                         const std::vector<double>& gain,
                                         const std::vector<double>& bias) {
  const std::size_t columns = gain.size();
  std::vector<double> y(x.size());
  for (std::size_t begin = 0; begin < x.size(); begin += columns) {
    const auto s = statistics(x, begin, columns);
    for (std::size_t i = 0; i < columns; ++i)
      y[begin + i] = gain[i] * (x[begin + i] - s.mean) / s.deviation + bias[i];
  }
  return y;
}

LayerNormGradients layer_norm_backward_reference(const std::vector<double>& x,
                                                 const std::vector<double>& gain,
                                                 const std::vector<double>& grad_y) {
  const std::size_t columns = gain.size();
  LayerNormGradients grad{std::vector<double>(x.size()), std::vector<double>(columns),
                          std::vector<double>(columns)};
  for (std::size_t begin = 0; begin < x.size(); begin += columns) {
    const auto s = statistics(x, begin, columns);
    const auto normal = [&](std::size_t i) { return (x[begin + i] - s.mean) / s.deviation; };
    double mean_g = 0.0, mean_gn = 0.0;
    for (std::size_t i = 0; i < columns; ++i) {
      const double g = gain[i] * grad_y[begin + i];
      mean_g += g / columns;
      mean_gn += g * normal(i) / columns;
      grad.gain[i] += grad_y[begin + i] * normal(i);
      grad.bias[i] += grad_y[begin + i];
    }
    for (std::size_t i = 0; i < columns; ++i)
      grad.x[begin + i] =
          (gain[i] * grad_y[begin + i] - mean_g - normal(i) * mean_gn) / s.deviation;
  }
  return grad;
}

}  // namespace touchtrace
