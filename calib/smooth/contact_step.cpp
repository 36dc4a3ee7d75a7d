#include <array>
#include <cmath>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {
namespace {

constexpr int num_nodes = 8;
using Nodes = Eigen::Array<double, num_nodes, 1>;

/// Nodes of Gauss-Legendre quadrature on [0, 1], and their weights.
const Nodes nodes = [] {
  Eigen::Array4d positive{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                          0.9602898564975363};
  Nodes both;
  both << -positive, positive;
  return Nodes(0.5 + 0.5 * both);
}();
const Nodes weights = [] {
  const Eigen::Array4d half{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                            0.1012285362903763};
  Nodes both;
  both << half, half;
  return Nodes(0.5 * both);
}();
/// Longest step times bandwidth for which quadrature and series are exact to rounding.
constexpr double max_direct_step = 0.5;

/// Sum of x^(j - 2) / j! over j = 2 .. 15, for 0 <= x <= max_direct_step: (e^x - 1 - x) / x^2.
template <class X>
X exponential_after_two_terms(const X& x) {
  constexpr int last = 15;
  static constexpr auto inverse_factorials = [] {
    std::array<double, last + 1> inverse{1.0};
    for (int j = 1; j <= last; ++j)
      inverse[static_cast<std::size_t>(j)] = inverse[static_cast<std::size_t>(j - 1)] / j;
    return inverse;
  }();
  X sum = x * inverse_factorials[last] + inverse_factorials[last - 1];
  for (std::size_t j = last - 1; j-- > 2;) sum = sum * x + inverse_factorials[j];
  return sum;
}

/// Responses of position, velocity and acceleration to a unit impulse of the jerk `h` ago [nodes].
Eigen::Matrix<double, motion_size, num_nodes> impulse_responses(const Nodes& h, double bandwidth) {
  const Nodes x = bandwidth * h, tail = exponential_after_two_terms(x),
              decay = (1.0 + x * (1.0 + x * tail)).inverse();
  Eigen::Matrix<double, motion_size, num_nodes> responses;
  responses.row(0) = (h * h * tail * decay).matrix().transpose();
  responses.row(1) = (h * decay).matrix().transpose();
  responses.row(2) = ((1.0 - x) * decay).matrix().transpose();
  return responses;
}

Transition<motion_size> direct_step(double h, double density, double bandwidth) {
  const double x = bandwidth * h, tail = exponential_after_two_terms(x),
               decay = 1.0 / (1.0 + x * (1.0 + x * tail));
  Transition<motion_size> step;
  step.F.col(1) << h * (1.0 + 2.0 * x * tail) * decay, (1.0 + x) * decay, -bandwidth * x * decay;
  step.F.col(2) << h * h * tail * decay, h * decay, (1.0 - x) * decay;
  const auto responses = impulse_responses(h * nodes, bandwidth);
  step.Q = (responses * (h * density * weights).matrix().asDiagonal())
               .lazyProduct(responses.transpose());
  return step;
}

}  // namespace

Transition<motion_size> contact_step(double h, double density, double bandwidth) {
  int num_doublings = 0;
  for (; bandwidth * h > max_direct_step; ++num_doublings) h /= 2.0;
  auto step = direct_step(h, density, bandwidth);
  for (; num_doublings > 0; --num_doublings) step = step.then(step);
  return step;
}

}  // namespace touchtrace
