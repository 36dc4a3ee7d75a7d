#include "pipeline/scene/camera/board_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/random.h"

namespace touchtrace::scene {
namespace {

constexpr double min_distance_m = 0.4, max_distance_m = 1.2;
constexpr double max_tilt_rad = std::numbers::pi / 4, max_roll_rad = std::numbers::pi / 8;
constexpr double min_square_px = 8.0;
constexpr int grid_columns = 4, grid_rows = 3;

Eigen::Vector2d position_in_image(RandomStream& random, const Camera& camera, int view) {
  const int cell = view % (grid_columns * grid_rows);
  const double x = (cell % grid_columns + random.uniform()) / grid_columns;
  const double y = (cell / grid_columns + random.uniform()) / grid_rows;
  return {x * camera.width, y * camera.height};
}

Eigen::Isometry3d draw_pose(RandomStream& random, const Camera& camera, int view) {
  const Eigen::Vector3d ray = camera.unproject(position_in_image(random, camera, view));
  const double direction = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d axis(std::cos(direction), std::sin(direction), 0.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(random.uniform(0.0, max_tilt_rad), axis) *
       Eigen::AngleAxisd(random.uniform(-max_roll_rad, max_roll_rad), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  pose.translation() = ray * random.uniform(min_distance_m, max_distance_m);
  return pose;
}

/// Corner (column, row) of the squares, from -1 to columns + 2 with the outer squares and the
/// margin.
Eigen::Vector3d square_corner(const BoardInfo& board, int column, int row) {
  return board.square_m *
         Eigen::Vector3d(column - 0.5 * (board.columns + 1), row - 0.5 * (board.rows + 1), 0.0);
}

bool is_inside(const Camera& camera, const Eigen::Vector3d& point) {
  if (point.z() < 0.1) return false;
  const Eigen::Vector2d pixel = camera.project(point);
  return pixel.x() > 1.0 && pixel.y() > 1.0 && pixel.x() < camera.width - 2.0 &&
         pixel.y() < camera.height - 2.0;
}

double narrowest_square_px(const Camera& camera, const BoardInfo& board,
                           const Eigen::Isometry3d& pose) {
  double narrowest = camera.width;
  for (int row : {0, board.rows})
    for (int column : {0, board.columns}) {
      const auto pixel = [&](int c, int r) -> Eigen::Vector2d {
        return camera.project(pose * square_corner(board, c, r));
      };
      const Eigen::Vector2d across = pixel(column + 1, row) - pixel(column, row);
      const Eigen::Vector2d down = pixel(column, row + 1) - pixel(column, row);
      const double area = std::abs(across.x() * down.y() - across.y() * down.x());
      narrowest = std::min(narrowest, area / std::max(across.norm(), down.norm()));
    }
  return narrowest;
}

bool is_usable(const RgbdCamera& camera, const BoardInfo& board,
               const Eigen::Isometry3d& color_from_board) {
  for (int row : {-1, board.rows + 2})
    for (int column : {-1, board.columns + 2}) {
      const Eigen::Vector3d corner = color_from_board * square_corner(board, column, row);
      if (!is_inside(camera.color, corner) ||
          !is_inside(camera.depth, camera.depth_from_color * corner))
        return false;
    }
  return narrowest_square_px(camera.color, board, color_from_board) >= min_square_px;
}

}  // namespace

std::vector<Eigen::Isometry3d> board_poses(const RgbdCamera& camera, const BoardInfo& board,
                                           int count, std::uint64_t seed) {
  constexpr int max_attempts = 1000;
  RandomStream random(seed, "board poses");
  std::vector<Eigen::Isometry3d> poses;
  for (int view = 0; view < count; ++view)
    for (int i = 0; i < max_attempts; ++i) {
      const Eigen::Isometry3d pose =
          draw_pose(random, camera.color, i < max_attempts / 2 ? view : i);
      if (!is_usable(camera, board, pose)) continue;
      poses.push_back(pose);
      break;
    }
  return poses;
}

}  // namespace touchtrace::scene
