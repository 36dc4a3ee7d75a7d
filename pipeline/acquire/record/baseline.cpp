#include "pipeline/acquire/record/baseline.h"

#include "engine/base/statistics.h"

namespace touchtrace {

std::vector<float> median_counts(std::span<const std::uint16_t> frames, std::size_t taxels) {
  std::vector<float> baseline(taxels, 0.0f);
  if (frames.empty()) return baseline;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    std::vector<double> values;
    for (std::size_t i = taxel; i < frames.size(); i += taxels) values.push_back(frames[i]);
    baseline[taxel] = static_cast<float>(median(std::move(values)));
  }
  return baseline;
}

bool RestBaseline::add(double time_s, std::span<const std::uint16_t> counts) {
  if (frames_.empty()) end_s_ = time_s + rest_s_;
  if (!(time_s < end_s_)) return false;
  frames_.insert(frames_.end(), counts.begin(), counts.end());
  return true;
}

}  // namespace touchtrace
