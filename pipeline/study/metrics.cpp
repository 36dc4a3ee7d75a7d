#include "pipeline/study/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::study {
namespace {

int steps_of(Path path) { return static_cast<int>(path.size()) / state_size; }

double squared_distance(const float* a, const float* b, int dimensions) {
  double sum = 0.0;
  for (int d = 0; d < dimensions; ++d) {
    const double difference = static_cast<double>(a[d]) - static_cast<double>(b[d]);
    sum += difference * difference;
  }
  return sum;
}

double directed_squared(Path from, Path to) {
  double farthest = 0.0;
  for (int i = 0; i < steps_of(from); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int j = 0; j < steps_of(to); ++j)
      nearest = std::min(nearest,
                         squared_distance(&from[i * state_size], &to[j * state_size], state_size));
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

double hausdorff(Path a, Path b) {
  return std::sqrt(std::max(directed_squared(a, b), directed_squared(b, a)));
}

std::vector<double> distance_by_step(Path predicted_m, Path target_m, int first) {
  std::vector<double> distances;
  for (int step = 0; step < steps_of(predicted_m); ++step) {
    const int at = step * state_size + first;
    distances.push_back(std::sqrt(squared_distance(&predicted_m[at], &target_m[at], 3)));
  }
  return distances;
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
