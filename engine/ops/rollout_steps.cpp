#include "engine/ops/rollout_steps.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

}  // namespace

std::vector<double> step_of(const std::vector<double>& all, int t, std::size_t size) {
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(t * size);
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

void append(std::vector<double>& all, const std::vector<double>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

void add(std::vector<double>& sum, const std::vector<double>& part) {
  if (sum.empty()) sum.resize(part.size(), 0.0);
  for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
}

void append_prediction(const std::vector<double>& out, int state, std::vector<double>& states,
                       std::vector<double>& spread) {
  const std::size_t size = out.size() / 2, now = states.size() - size;
  for (std::size_t i = 0; i < size; ++i) {
    const auto delta = i / state * 2 * state + i % state;
    states.push_back(states[now + i] + out[delta]);
    spread.push_back(softplus(out[delta + state]));
  }
}

void scale_weights(std::vector<std::vector<double>>& arrays, std::size_t first, int hidden) {
  const double scale = std::exp2(-std::ceil(0.5 * std::log2(hidden)));
  for (std::size_t i = first; i < arrays.size(); ++i)
    for (std::size_t j = 0; j < arrays[i].size(); ++j)
      arrays[i][j] = (j % 2 == 0 ? scale : -scale) * std::clamp(arrays[i][j], -4.0, 4.0);
}

std::vector<double> output_gradient(int state, const std::vector<double>& carry,
                                    const std::vector<double>& grad_spread,
                                    const std::vector<double>& spread) {
  std::vector<double> grad(2 * carry.size());
  for (std::size_t i = 0; i < carry.size(); ++i) {
    const auto delta = i / state * 2 * state + i % state;
    grad[delta] = carry[i];
    grad[delta + state] = grad_spread[i] * -std::expm1(-spread[i]);
  }
  return grad;
}

}  // namespace touchtrace
