#include "pipeline/acquire/stamp_unit.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/progress.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr double max_stamp_rate_hz = 1000.0, min_image_rate_hz = 0.05;

const std::array<StampUnit, 4>& stamp_units() {
  static const std::array<StampUnit, 4> units{
      {{"seconds", 1.0}, {"milliseconds", 1e3}, {"microseconds", 1e6}, {"nanoseconds", 1e9}}};
  return units;
}

/// Unit in which the latest stamp is a time after 1970.
const StampUnit& unit_by_size(const std::vector<double>& stamps) {
  const auto& units = stamp_units();
  double latest = 0.0;
  for (const double stamp : stamps)
    if (std::isfinite(stamp)) latest = std::max(latest, stamp);
  return latest >= 1e17   ? units[3]
         : latest >= 1e14 ? units[2]
         : latest >= 1e11 ? units[1]
                          : units[0];
}

}  // namespace

double frames_per_stamp(std::vector<double> stamps) {
  std::erase_if(stamps, [](double stamp) { return !std::isfinite(stamp); });
  const auto frames = static_cast<double>(stamps.size());
  std::ranges::sort(stamps);
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  if (stamps.size() < 2) return 0.0;
  const auto different = static_cast<double>(stamps.size());
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) stamps[i] = stamps[i + 1] - stamps[i];
  stamps.pop_back();
  return frames / different / median(std::move(stamps));
}

std::optional<StampUnit> stamp_unit(const std::vector<double>& stamps, double min_rate_hz) {
  const double per_stamp = frames_per_stamp(stamps);
  const StampUnit& by_size = unit_by_size(stamps);
  const auto is_plausible = [&](const StampUnit& unit) {
    const double rate_hz = per_stamp * unit.per_second;
    return rate_hz >= min_rate_hz && rate_hz <= max_stamp_rate_hz;
  };
  if (per_stamp == 0.0 || is_plausible(by_size)) return by_size;
  const auto found = std::ranges::find_if(stamp_units(), is_plausible);
  return found == stamp_units().end() ? std::nullopt : std::optional(*found);
}

std::vector<double> in_seconds(std::vector<double> stamps, const std::string& source) {
  const auto unit = stamp_unit(stamps, min_image_rate_hz);
  if (!unit || unit->per_second == 1.0) return stamps;
  Progress::report(fmt::format("{}: the stamps are in {}", source, unit->name));
  for (double& stamp : stamps) stamp /= unit->per_second;
  return stamps;
}

}  // namespace touchtrace
