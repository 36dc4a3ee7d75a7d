#include "pipeline/study/truth_samples.h"

#include <algorithm>
#include <array>

namespace touchtrace::study {

Eigen::Vector3d row(const std::vector<double>& values, std::size_t index) {
  return Eigen::Map<const Eigen::Vector3d>(&values[3 * index]);
}

std::optional<TruthInterval> find_interval(const Truth& truth, std::int32_t clip, double time_s) {
  const auto [first, last] = std::ranges::equal_range(truth.clip, clip);
  const auto begin = truth.time_s.begin() + (first - truth.clip.begin());
  const auto end = truth.time_s.begin() + (last - truth.clip.begin());
  const auto after = std::upper_bound(begin, end, time_s);
  if (after == begin || after == end) return std::nullopt;
  return TruthInterval{static_cast<std::size_t>(after - truth.time_s.begin()) - 1,
                       (time_s - *(after - 1)) / (*after - *(after - 1))};
}

Eigen::Vector3d interpolate(const std::vector<double>& values, const TruthInterval& interval) {
  return (1.0 - interval.fraction) * row(values, interval.index) +
         interval.fraction * row(values, interval.index + 1);
}

double acceleration(const Truth& truth, const Truth::Body& body, const TruthInterval& interval) {
  return (row(body.velocity_m_per_s, interval.index + 1) -
          row(body.velocity_m_per_s, interval.index))
             .norm() /
         (truth.time_s[interval.index + 1] - truth.time_s[interval.index]);
}

bool in_image(const Truth& truth, const Eigen::Vector3d& position_m) {
  if (!truth.calibration.contains("color")) return true;
  const auto& color = truth.calibration.at("color");
  const auto lens = color.at("intrinsics_px").get<std::array<double, 4>>();
  const double u = lens[0] * position_m.x() / position_m.z() + lens[2],
               v = lens[1] * position_m.y() / position_m.z() + lens[3];
  return position_m.z() > 0.0 && u >= 0.0 && v >= 0.0 && u < color.at("width").get<double>() &&
         v < color.at("height").get<double>();
}

}  // namespace touchtrace::study
