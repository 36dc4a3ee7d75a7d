#include "pipeline/acquire/glove/baseline.h"

#include <algorithm>

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

std::vector<float> resting_baseline(const GloveStream& glove, double rest_s) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  const double end_s = glove.host_time_s.front() + rest_s;
  const auto frames = static_cast<std::size_t>(std::ranges::lower_bound(glove.host_time_s, end_s) -
                                               glove.host_time_s.begin());
  return median_counts(std::span(glove.counts).first(frames * taxels), taxels);
}

bool RestBaseline::add(double time_s, std::span<const std::uint16_t> counts) {
  if (frames_.empty()) end_s_ = time_s + rest_s_;
  if (!(time_s < end_s_)) return false;
  frames_.insert(frames_.end(), counts.begin(), counts.end());
  return true;
}

}  // namespace touchtrace
