#include "pipeline/label/estimate/pose_jumps.h"

#include <algorithm>

namespace touchtrace::label {
namespace {

constexpr double min_jump_m = 0.03, min_jump_sigmas = 2.0;
constexpr double max_step_s = 0.4;  // after a longer gap any step is possible

/// Vector from the segment between zero and `end` to a point.
Eigen::Vector3d from_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& end) {
  const double square = end.squaredNorm();
  const double part = square > 0.0 ? std::clamp(point.dot(end) / square, 0.0, 1.0) : 0.0;
  return point - part * end;
}

/// Jump between view `i` and the one before it; zero if there is none.
Eigen::Vector3d jump_before(const std::vector<PosedView>& views, std::size_t i) {
  const auto step = [&](std::size_t to) -> Eigen::Vector3d {
    return views[to].centre_m - views[to - 1].centre_m;
  };
  const PosedView &from = views[i - 1], &to = views[i];
  const Eigen::Vector3d jump =
      from_segment(step(i), to.visible_centroid_m - from.visible_centroid_m);
  double unexplained_m = jump.norm();
  if (i > 1) unexplained_m = std::min(unexplained_m, (step(i) - step(i - 1)).norm());
  if (i + 1 < views.size()) unexplained_m = std::min(unexplained_m, (step(i) - step(i + 1)).norm());
  const double sigma_m = std::max(from.sigma_m.maxCoeff(), to.sigma_m.maxCoeff());
  const bool is_jump = to.time_s - from.time_s <= max_step_s && unexplained_m > min_jump_m &&
                       unexplained_m > min_jump_sigmas * sigma_m;
  return is_jump ? jump : Eigen::Vector3d::Zero();
}

}  // namespace

std::vector<Eigen::Vector3d> jump_variances(const std::vector<PosedView>& views) {
  std::vector<Eigen::Vector3d> offsets_m(views.size(), Eigen::Vector3d::Zero());
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero(), mean_square_m2 = mean_m;
  for (std::size_t i = 1; i < views.size(); ++i) {
    offsets_m[i] = offsets_m[i - 1] + jump_before(views, i);
    mean_m += offsets_m[i] / static_cast<double>(views.size());
    mean_square_m2 += offsets_m[i].cwiseAbs2() / static_cast<double>(views.size());
  }
  const Eigen::Vector3d variance_m2 = mean_square_m2 - mean_m.cwiseAbs2();
  for (auto& offset : offsets_m) offset = (offset - mean_m).cwiseAbs2() + variance_m2.cwiseMax(0.0);
  return offsets_m;
}

}  // namespace touchtrace::label
