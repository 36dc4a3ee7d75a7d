#include "engine/train/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchtrace {

Buffer<float> decays(Runtime& runtime, const ParameterTable& table, double weight_decay) {
  std::vector<float> decay(table.size(), 0.0f);
  for (const auto& row : table.rows())
    if (row.shape.size() >= 2)
      std::fill_n(decay.begin() + static_cast<std::ptrdiff_t>(row.offset), row.size,
                  static_cast<float>(weight_decay));
  return runtime.upload<float>(decay);
}

double learning_rate(const TrainOptions& options, int update) {
  const double done = std::min(1.0, static_cast<double>(update) / options.updates);
  return 0.5 * options.learning_rate * (1.0 + std::cos(std::numbers::pi * done));
}

}  // namespace touchtrace
