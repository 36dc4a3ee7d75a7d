#include "engine/ops/activation.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr std::array<std::pair<Activation, std::string_view>, 3> activation_names{
    {{Activation::relu, "relu"}, {Activation::silu, "silu"}, {Activation::tanh, "tanh"}}};

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

double value_at(Activation activation, double x) {
  if (activation == Activation::silu) return x * sigmoid(x);
  return activation == Activation::tanh ? std::tanh(x) : std::max(x, 0.0);
}

double slope_at(Activation activation, double x) {
  if (activation == Activation::silu) return sigmoid(x) * (1.0 + x * sigmoid(-x));
  if (activation == Activation::tanh) return 1.0 - std::tanh(x) * std::tanh(x);
  return x > 0 ? 1.0 : 0.0;
}

}  // namespace

std::string_view name_of(Activation activation) {
  return std::ranges::find(activation_names, activation,
                           &decltype(activation_names)::value_type::first)
      ->second;
}

Activation activation_of(std::string_view name) {
  const auto found =
      std::ranges::find(activation_names, name, &decltype(activation_names)::value_type::second);
  if (found == activation_names.end())
    throw usage_error(fmt::format("unknown activation '{}'", name), "use relu, silu or tanh");
  return found->first;
}

std::vector<double> activation_reference(Activation activation, std::vector<double> sums) {
  for (double& x : sums) x = value_at(activation, x);
  return sums;
}

std::vector<double> activation_backward_reference(Activation activation,
                                                  const std::vector<double>& sums,
                                                  std::vector<double> grad) {
  for (std::size_t i = 0; i < grad.size(); ++i) grad[i] *= slope_at(activation, sums[i]);
  return grad;
}

}  // namespace touchtrace
