#include "pipeline/study/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::study {
namespace {

int steps_of(Path path) { return static_cast<int>(path.size()) / state_size; }

double squared_distance(const float* a, const float* b, Dimensions dimensions) {
  double sum = 0.0;
  for (int d = dimensions.first; d < dimensions.first + dimensions.count; ++d) {
    const double difference = static_cast<double>(a[d]) - static_cast<double>(b[d]);
    sum += difference * difference;
  }
  return sum;
}

double directed_squared(Path from, Path to, Dimensions dimensions) {
  double farthest = 0.0;
  for (int i = 0; i < steps_of(from); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int j = 0; j < steps_of(to); ++j)
      nearest = std::min(nearest,
                         squared_distance(&from[i * state_size], &to[j * state_size], dimensions));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace

std::vector<double> l1_by_step(Path predicted, Path target) {
  std::vector<double> errors(static_cast<std::size_t>(steps_of(predicted)), 0.0);
  for (std::size_t i = 0; i < predicted.size(); ++i)
    errors[i / state_size] += std::abs(static_cast<double>(predicted[i]) - target[i]) / state_size;
  return errors;
}

double hausdorff(Path a, Path b, Dimensions dimensions) {
  if (a.empty() || b.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(
      std::max(directed_squared(a, b, dimensions), directed_squared(b, a, dimensions)));
}

std::vector<double> distance_by_step(Path predicted, Path target, Dimensions dimensions) {
  std::vector<double> distances;
  for (int step = 0; step < steps_of(predicted); ++step)
    distances.push_back(std::sqrt(
        squared_distance(&predicted[step * state_size], &target[step * state_size], dimensions)));
  return distances;
}

std::vector<float> weighted_steps(Path path, std::span<const float> weight) {
  std::vector<float> states;
  for (std::size_t step = 0; step < weight.size(); ++step) {
    const auto state = path.subspan(step * state_size, state_size);
    if (weight[step] > 0.0f) states.insert(states.end(), state.begin(), state.end());
  }
  return states;
}

double mean_until(std::span<const double> by_step, std::span<const float> weight, int steps) {
  double sum = 0.0, total = 0.0;
  for (int step = 0; step < std::min<int>(steps, static_cast<int>(by_step.size())); ++step) {
    if (weight[step] <= 0.0f) continue;
    sum += weight[step] * by_step[step];
    total += weight[step];
  }
  return total > 0.0 ? sum / total : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace touchtrace::study
