#include "engine/check/operation_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Arrays normal_like(const Arrays& shapes, RandomStream& random) {
  Arrays arrays;
  for (const auto& shape : shapes) arrays.push_back(normal_floats<double>(shape.size(), random));
  return arrays;
}

/// Sum in long double, so that central differences do not show the rounding of double.
long double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0L);
}

double dot(const Arrays& a, const Arrays& b) {
  long double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return static_cast<double>(sum);
}

double size(const Arrays& arrays) {
  double sum = 0.0;
  for (const auto& array : arrays) sum += static_cast<double>(array.size());
  return sum;
}

double largest(const std::vector<double>& values) {
  double scale = 0.0;
  for (double value : values) scale = std::max(scale, std::abs(value));
  return scale;
}

/// Replaces NaN by infinity, so that it never passes.
double worse(double worst, double error) {
  return error <= worst ? worst : error >= 0 ? error : infinite;
}

/// inputs + step * direction, where the operation has a gradient.
Arrays moved(Arrays inputs, const Arrays& direction, double step) {
  for (std::size_t i = 0; i < direction.size(); ++i)
    for (std::size_t j = 0; j < direction[i].size(); ++j) inputs[i][j] += step * direction[i][j];
  return inputs;
}

/// Random unit vector in the space of the gradient.
Arrays unit_direction(const Arrays& gradient, RandomStream& random) {
  auto direction = normal_like(gradient, random);
  const double length = std::sqrt(dot(direction, direction));
  for (auto& array : direction)
    for (auto& value : array) value /= length;
  return direction;
}

}  // namespace

double array_error(const std::vector<double>& actual, const std::vector<double>& reference,
                   double n, double underflow) {
  if (actual.size() != reference.size()) return infinite;
  const double unit = std::numeric_limits<float>::epsilon() * std::sqrt(n) * largest(reference);
  double worst = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double off = std::abs(actual[i] - reference[i]);
    if (!(off <= underflow)) worst = worse(worst, unit > 0 ? off / unit : infinite);
  }
  return worst;
}

double norm_error(const std::vector<double>& actual, std::vector<double> reference) {
  if (actual.size() != reference.size()) return infinite;
  const double norm = std::sqrt(dot(reference, reference));
  for (std::size_t i = 0; i < actual.size(); ++i) reference[i] -= actual[i];
  const double off = std::sqrt(dot(reference, reference));
  return off == 0 ? 0.0 : worse(0.0, off / norm);
}

Arrays draw_inputs(const OperationCase& operation, std::uint64_t seed, double kink_margin) {
  RandomStream random(seed, "inputs of " + operation.shape);
  for (int trial = 0; trial < 100; ++trial) {
    Arrays inputs;
    for (const auto size : operation.input_sizes)
      inputs.push_back(normal_floats<double>(size, random));
    if (operation.prepare) operation.prepare(inputs);
    if (!operation.kink_distance || kink_margin == 0 ||
        operation.kink_distance(inputs) > kink_margin)
      return inputs;
  }
  throw failure("no inputs of " + operation.shape + " are far enough from a kink",
                "make the case smaller");
}

double output_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                    double underflow) {
  const auto reference = operation.reference(inputs);
  const auto actual = operation.forward(runtime, inputs);
  if (actual.size() != reference.size()) return infinite;
  double worst = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    worst = worse(worst, array_error(actual[i], reference[i], operation.terms, underflow));
  return worst;
}

double gradient_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                      std::uint64_t seed) {
  RandomStream random(seed, "output gradients of " + operation.shape);
  const auto output_gradients = normal_like(operation.reference(inputs), random);
  const auto reference = operation.reference_backward(inputs, output_gradients);
  const auto actual = operation.backward(runtime, inputs, output_gradients);
  if (actual.size() != reference.size()) return infinite;
  double worst = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    worst = worse(worst, norm_error(actual[i], reference[i]));
  return worst;
}

double reference_gradient_error(const OperationCase& operation, const Arrays& inputs,
                                std::uint64_t seed, double step) {
  RandomStream random(seed, "directions of " + operation.shape);
  const auto output_gradients = normal_like(operation.reference(inputs), random);
  const auto gradient = operation.reference_backward(inputs, output_gradients);
  const auto value = [&](const Arrays& at) {
    return dot(operation.reference(at), output_gradients);
  };
  double worst = 0.0;
  for (int trial = 0; trial < 5; ++trial) {
    const auto direction = unit_direction(gradient, random);
    const double difference =
        (value(moved(inputs, direction, step)) - value(moved(inputs, direction, -step))) /
        (2 * step);
    const double expected = std::sqrt(dot(gradient, gradient) / size(gradient));
    worst = worse(worst, std::abs(difference - dot(gradient, direction)) / expected);
  }
  return worst;
}

}  // namespace touchtrace
