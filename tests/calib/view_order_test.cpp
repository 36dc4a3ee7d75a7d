#include "calib/board/view_order.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace touchtrace {
namespace {

const CalibrationTarget symmetric{8, 6, 0.03};

/// Corners `first` to `last` of the board, turned by an angle in the image; with ids if these are
/// not all.
BoardView view_of(int first, int last, double angle_rad) {
  BoardView view;
  for (int id = first; id <= last; ++id) {
    view.corners_px.push_back(Eigen::Vector2d(320.0, 240.0) +
                              Eigen::Rotation2Dd(angle_rad) *
                                  (1000.0 * symmetric.corner_m(id).head<2>()));
    if (first > 0 || last + 1 < symmetric.num_corners()) view.corner_ids.push_back(id);
  }
  return view;
}

Eigen::Vector2d corner(const BoardView& view, int id) {
  for (std::size_t i = 0; i < view.corners_px.size(); ++i)
    if (view.corner_id(i) == id) return view.corners_px[i];
  return Eigen::Vector2d::Constant(std::nan(""));
}

TEST(ViewOrder, DiagonalOfAPartIsThatOfTheBoard) {
  const Eigen::Vector2d whole = diagonal_px(view_of(0, 47, 0.3), symmetric),
                        part = diagonal_px(view_of(10, 30, 0.3), symmetric);
  EXPECT_LT((whole - part).norm(), 1e-9);
}

TEST(ViewOrder, HalfATurnOfAPartKeepsItsPlaces) {
  BoardView part = view_of(10, 30, 0.3);
  const BoardView before = part;
  turn_by_half(part, symmetric);
  for (int id = 10; id <= 30; ++id) EXPECT_EQ(corner(part, 47 - id), corner(before, id));
}

/// Whole and partial views, every second one half a turn from the first, which is a part.
TEST(ViewOrder, AlignsWholeAndPartialViews) {
  BoardObservations aligned;
  aligned.board = symmetric;
  for (double angle_rad : {0.1, 0.4, -0.3, 1.0})
    for (const auto& [first, last] : {std::pair{10, 30}, {0, 47}})
      aligned.views.push_back(view_of(first, last, angle_rad));
  BoardObservations turned = aligned;
  for (std::size_t i = 1; i < turned.views.size(); i += 2) turn_by_half(turned.views[i], symmetric);
  for (std::size_t i = 4; i < 6; ++i) turn_by_half(turned.views[i], symmetric);
  align_symmetric_views(turned);
  for (std::size_t i = 0; i < turned.views.size(); ++i)
    for (int id = 10; id <= 30; ++id)
      EXPECT_EQ(corner(turned.views[i], id), corner(aligned.views[i], id)) << i << " " << id;
}

}  // namespace
}  // namespace touchtrace
