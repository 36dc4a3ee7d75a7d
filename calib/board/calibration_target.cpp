#include "calib/board/calibration_target.h"

#include <Eigen/LU>
#include <algorithm>
#include <ranges>

namespace touchtrace {
namespace {

constexpr std::size_t min_corners = 8;

constexpr const TargetKind* kinds[] = {&chessboard_kind, &charuco_kind, &aprilgrid_kind,
                                       &aruco_grid_kind, &circles_kind, &asymmetric_circles_kind};

}  // namespace

std::span<const TargetKind* const> target_kinds() { return kinds; }

std::optional<OtherTarget> recognize_target(const GreyImage& image, const TargetKind& except) {
  // From the last one on: a tag may look like a part of a chessboard.
  for (const TargetKind* kind : kinds | std::views::reverse)
    if (kind != &except && kind->recognize)
      if (const auto other = kind->recognize(image)) return other;
  return {};
}

Eigen::Vector2d square_lattice_m(const CalibrationTarget& target, int column, int row) {
  return target.square_m * Eigen::Vector2d(column, row);
}

bool determine_pose(const std::vector<int>& ids, const CalibrationTarget& target) {
  if (ids.size() < min_corners) return false;
  const auto differ = [&](auto coordinate) {
    const auto [min, max] = std::ranges::minmax(ids, {}, coordinate);
    return coordinate(min) != coordinate(max);
  };
  return differ([&](int i) { return i / target.columns; }) &&
         differ([&](int i) { return i % target.columns; });
}

Eigen::Matrix2d image_scale_px_per_m(const TargetCorners& corners,
                                     const CalibrationTarget& target) {
  const auto& [in_px, ids] = corners;
  const auto n = static_cast<Eigen::Index>(in_px.size());
  Eigen::Matrix2Xd on_board_m(2, n), in_image_px(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    on_board_m.col(i) = target.corner_m(ids.empty() ? int(i) : ids[at]).head<2>();
    in_image_px.col(i) = in_px[at];
  }
  on_board_m.colwise() -= on_board_m.rowwise().mean().eval();
  return in_image_px * on_board_m.transpose() * (on_board_m * on_board_m.transpose()).inverse();
}

}  // namespace touchtrace
