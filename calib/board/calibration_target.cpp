#include "calib/board/calibration_target.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
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

bool can_determine_pose(const std::vector<int>& ids, const CalibrationTarget& target) {
  if (ids.size() < min_corners) return false;
  std::map<int, int> in_row, in_column;
  for (const int id : ids) ++in_row[id / target.columns], ++in_column[id % target.columns];
  const auto has_two_lines = [](const std::map<int, int>& corners) {
    return std::ranges::count_if(corners, [](const auto& line) { return line.second > 1; }) > 1;
  };
  return has_two_lines(in_row) || has_two_lines(in_column);
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
