#include "pipeline/scene/camera/backdrop.h"

#include <cmath>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double board_thickness_m = 0.004;

PaintedSolid painted(const Solid& solid, double contrast, double waves_per_m) {
  if (contrast <= 0.0) return {solid};
  return {solid, Pattern::cloth, {contrast, waves_per_m, 0.0}};
}

PaintedSolid painted(ShapeKind kind, const Vector3d& size_m, const Vector3d& centre_m,
                     const Vector3d& color, double contrast = 0.0, double waves_per_m = 0.0) {
  Solid solid{kind, size_m, Eigen::Isometry3d::Identity(), color};
  solid.body_from_shape.translation() = centre_m;
  return painted(solid, contrast, waves_per_m);
}

PaintedSolid limb(const Vector3d& from_m, const Vector3d& to_m, double radius_m,
                  const Vector3d& color, double contrast = 0.0, double waves_per_m = 0.0) {
  return painted(capsule_between(from_m, to_m, radius_m, color), contrast, waves_per_m);
}

const Vector3d shirt(0.30, 0.11, 0.10), trousers(0.05, 0.07, 0.16), skin(0.62, 0.38, 0.28),
    hair(0.06, 0.04, 0.03), wood(0.36, 0.22, 0.11), paint(0.52, 0.50, 0.44);
constexpr double weave_per_m = 23.0, weave_contrast = 0.12;

/// Smooth motion between -1 and 1 with two incommensurable periods of seconds.
double sway(double time_s, double phase) {
  return 0.6 * std::sin(1.7 * time_s + phase) + 0.4 * std::sin(0.73 * time_s + 2.1 * phase);
}

}  // namespace

std::vector<PaintedSolid> room_solids() {
  using enum ShapeKind;
  return {
      painted(box, {4.0, 0.05, 3.0}, {0.0, 1.05, 1.0}, paint, 0.06, 3.1),             // wall
      painted(box, {4.0, 4.0, 0.05}, {0.0, 0.0, -0.05}, {0.30, 0.27, 0.24}, 0.1, 5),  // floor
      painted(box, {0.30, 0.01, 0.22}, {-0.62, 0.99, 1.55}, {0.10, 0.22, 0.32}, 0.25,
              6.0),                                                               // picture
      painted(box, {0.35, 0.12, 0.015}, {0.70, 0.88, 1.42}, wood, 0.15, 9.0),     // shelf
      painted(box, {0.02, 0.08, 0.11}, {0.55, 0.86, 1.545}, {0.10, 0.30, 0.14}),  // books on it
      painted(box, {0.025, 0.08, 0.12}, {0.61, 0.86, 1.555}, {0.45, 0.36, 0.10}),
      painted(box, {0.018, 0.08, 0.10}, {0.67, 0.86, 1.535}, {0.12, 0.14, 0.36}),
      painted(box, {0.40, 0.35, 0.02}, {0.72, 0.25, 0.90}, wood, 0.15, 9.0),         // table
      painted(cylinder, {0.04, 0.05, 0.0}, {0.48, 0.05, 0.97}, {0.70, 0.68, 0.62}),  // mug
      painted(box, {0.07, 0.10, 0.05}, {0.66, 0.15, 0.97}, {0.42, 0.32, 0.18}, 0.1,
              30.0),  // parcel
  };
}

std::vector<PaintedSolid> person_solids(double time_s) {
  const Vector3d head(0.008 * sway(time_s, 0.3), -0.02 + 0.008 * sway(time_s, 1.9), 1.66);
  const Vector3d left_hand(0.30 + 0.03 * sway(time_s, 0.8), -0.10 + 0.04 * sway(time_s, 2.6), 0.88);
  const Vector3d left_shoulder(0.20, 0.03, 1.42),
      left_elbow(0.27, 0.03 + 0.01 * sway(time_s, 2.6), 1.13);
  const Vector3d right_shoulder(-0.20, 0.03, 1.42), right_elbow(-0.22, -0.02, 1.02);
  const auto cloth = [](const Vector3d& a, const Vector3d& b, double radius_m,
                        const Vector3d& color) {
    return limb(a, b, radius_m, color, weave_contrast, weave_per_m);
  };
  return {
      cloth({-0.08, 0.04, 1.38}, {0.08, 0.04, 1.38}, 0.105, shirt),
      cloth({-0.07, 0.05, 1.24}, {0.07, 0.05, 1.24}, 0.115, shirt),
      cloth({-0.06, 0.05, 1.10}, {0.06, 0.05, 1.10}, 0.115, shirt),
      cloth({-0.05, 0.05, 0.98}, {0.05, 0.05, 0.98}, 0.120, trousers),
      cloth({-0.09, 0.05, 0.95}, {-0.10, 0.05, 0.40}, 0.075, trousers),
      cloth({0.09, 0.05, 0.95}, {0.10, 0.05, 0.40}, 0.075, trousers),
      cloth(right_shoulder, right_elbow, 0.048, shirt),
      cloth(left_shoulder, left_elbow, 0.048, shirt),
      cloth(left_elbow, left_hand, 0.040, shirt),
      painted(ShapeKind::sphere, {0.045, 0, 0}, left_hand, skin),
      limb({0.0, 0.02, 1.46}, head, 0.055, skin),
      limb(head - Vector3d(0, 0, 0.03), head + Vector3d(0, 0, 0.03), 0.085, skin),
      painted(ShapeKind::sphere, {0.096, 0, 0}, head + Vector3d(0.0, 0.022, 0.05), hair),
  };
}

PaintedSolid board_solid(const BoardInfo& board, const Eigen::Isometry3d& world_from_board) {
  const double columns = board.columns + 1, rows = board.rows + 1;
  PaintedSolid result;
  result.solid = {ShapeKind::box,
                  {0.5 * (columns + 2) * board.square_m, 0.5 * (rows + 2) * board.square_m,
                   0.5 * board_thickness_m},
                  world_from_board * Eigen::Translation3d(0.0, 0.0, 0.5 * board_thickness_m),
                  Vector3d::Constant(0.8)};
  result.pattern = Pattern::chessboard;
  result.pattern_values = {board.square_m, columns, rows};
  return result;
}

}  // namespace touchtrace::scene
