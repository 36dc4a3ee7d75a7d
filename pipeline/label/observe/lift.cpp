#include "pipeline/label/observe/lift.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr int max_shifts = 12;
constexpr double converged_m = 5e-4;

/// Centroid and number of the points of `body` within `radius_m` of `centre`; `centre` if none.
std::pair<Eigen::Vector3d, std::size_t> local_mean(const Surface& surface, Body body,
                                                   const Eigen::Vector3d& centre, double radius_m) {
  const Eigen::Vector3f centre_f = centre.cast<float>();
  const auto limit = static_cast<float>(radius_m * radius_m);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (const auto& point : surface) {
    if (point.body != body || (point.position_m - centre_f).squaredNorm() > limit) continue;
    sum += point.position_m.cast<double>();
    ++count;
  }
  return {count > 0 ? Eigen::Vector3d(sum / static_cast<double>(count)) : centre, count};
}

Patch gather(const Surface& surface, Body body, const Eigen::Vector3d& centre, double radius_m) {
  Patch patch;
  patch.centroid_m = centre;
  int left = 1 << 14, right = -1, top = 1 << 14, bottom = -1;
  for (const auto& point : surface) {
    if (point.body != body || (point.position_m.cast<double>() - centre).norm() > radius_m)
      continue;
    patch.points_m.push_back(point.position_m);
    patch.likeness += point.likeness;
    left = std::min<int>(left, point.u), right = std::max<int>(right, point.u);
    top = std::min<int>(top, point.v), bottom = std::max<int>(bottom, point.v);
  }
  patch.likeness /= std::max(1.0, static_cast<double>(patch.points_m.size()));
  patch.box = {left, top, right - left + 1, bottom - top + 1};
  return patch;
}

}  // namespace

std::optional<Patch> find_patch(const Surface& surface, Body body, const Eigen::Vector3d& start_m,
                                double radius_m, std::size_t min_points) {
  Eigen::Vector3d centre = start_m;
  for (int i = 0; i < max_shifts; ++i) {
    const auto [mean, count] = local_mean(surface, body, centre, radius_m);
    if (count < min_points) return std::nullopt;
    const double moved = (mean - centre).norm();
    centre = mean;
    if (moved < converged_m) break;
  }
  auto patch = gather(surface, body, centre, radius_m);
  if (patch.points_m.size() < min_points) return std::nullopt;
  return patch;
}

std::optional<Eigen::Vector3d> median_point(const Surface& surface, Body body,
                                            const Eigen::Vector3d& centre_m, double gate_m) {
  std::array<std::vector<double>, 3> coordinates;
  for (const auto& point : surface) {
    if (point.body != body || (point.position_m.cast<double>() - centre_m).norm() > gate_m)
      continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      coordinates[axis].push_back(point.position_m[static_cast<Eigen::Index>(axis)]);
  }
  if (coordinates[0].empty()) return std::nullopt;
  return Eigen::Vector3d(median(std::move(coordinates[0])), median(std::move(coordinates[1])),
                         median(std::move(coordinates[2])));
}

double silhouette_radius_m(const Patch& patch) {
  constexpr double disc_width = 1.374;  // of the middle 80 % of a uniform disc's points, in radii
  double widest = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<float> across;
    for (const auto& point : patch.points_m) across.push_back(point[axis]);
    std::ranges::sort(across);
    const auto tail = across.size() / 10;
    widest = std::max<double>(widest, across[across.size() - 1 - tail] - across[tail]);
  }
  return widest / disc_width;
}

}  // namespace touchtrace::label
