#include <array>
#include <cmath>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {
namespace {

/// Positive nodes of Gauss-Legendre quadrature with 8 points on [-1, 1], and their weights.
constexpr std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                      0.9602898564975363};
constexpr std::array<double, 4> weights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                        0.1012285362903763};
/// Longest step times bandwidth for which the quadrature is exact to rounding.
constexpr double max_direct_step = 0.5;

/// e^-x times the sum of x^(j - order) / j! over j >= order: a series of positive terms.
double tail_of_exponential(double x, int order) {
  double term = 1.0;
  for (int j = 2; j <= order; ++j) term /= j;
  double sum = term;
  for (int j = order + 1; term > 1e-17 * sum; ++j) sum += term *= x / j;
  return std::exp(-x) * sum;
}

/// Response of position, velocity and acceleration to a unit impulse of the jerk `h` ago.
Eigen::Vector3d impulse_response(double h, double bandwidth) {
  const double x = bandwidth * h, decay = std::exp(-x);
  return {h * h * tail_of_exponential(x, 2), h * decay, (1.0 - x) * decay};
}

Transition<motion_size> direct_step(double h, double density, double bandwidth) {
  const double x = bandwidth * h, decay = std::exp(-x);
  Transition<motion_size> step;
  step.F.col(1) << h * (tail_of_exponential(x, 1) + x * tail_of_exponential(x, 2)),
      (1.0 + x) * decay, -bandwidth * x * decay;
  step.F.col(2) = impulse_response(h, bandwidth);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const double sign : {-1.0, 1.0}) {
      const auto response = impulse_response(0.5 * h * (1.0 + sign * nodes[i]), bandwidth);
      step.Q += 0.5 * h * weights[i] * density * response * response.transpose();
    }
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
