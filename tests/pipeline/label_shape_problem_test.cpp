#include <gtest/gtest.h>

#include "pipeline/label/estimate/shape_problem.h"

namespace touchtrace::label {
namespace {

constexpr double compactness = 1.5, box_depth_m = 0.8;
const RoundedBody box{{0.03, 0.02, 0.01}, 0.002, Core::box};

/// Grid of points on one of the box's two faces perpendicular to an axis; body frame.
std::vector<Eigen::Vector3d> face_points(Eigen::Index axis, bool back) {
  const Eigen::Index one = (axis + 1) % 3, other = (axis + 2) % 3;
  std::vector<Eigen::Vector3d> points;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) {
      Eigen::Vector3d point;
      point[axis] = (back ? 1.0 : -1.0) * box.half_extents_m()[axis];
      point[one] = 0.18 * i * box.inner_m[one], point[other] = 0.18 * j * box.inner_m[other];
      points.push_back(point);
    }
  return points;
}

BodyView view_of(const std::vector<Eigen::Vector3d>& points) {
  BodyView view;
  for (const auto& point : points)
    view.surface_points.push_back((point + box_depth_m * Eigen::Vector3d::UnitZ()).cast<float>());
  return view;
}

Eigen::Vector3d half_extent_sigma_m(const std::vector<BodyView>& views) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.pretranslate(box_depth_m * Eigen::Vector3d::UnitZ());
  ShapeProblem problem(views, box, ShapeProblem::Poses(views.size(), pose), fine_loss_width_m,
                       compactness);
  return problem.half_extent_sigma_m();
}

TEST(ShapeProblem, UnseenExtentsHaveThePriorsSigma) {
  const Eigen::Vector3d sigma = half_extent_sigma_m({view_of(face_points(2, false))});
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(sigma[axis], point_sigma_m / compactness, 1e-4) << axis;
}

TEST(ShapeProblem, SigmaOfAnExtentWithBothFacesVisible) {
  auto points = face_points(2, false);
  const auto others = face_points(2, true);
  points.insert(points.end(), others.begin(), others.end());
  const Eigen::Vector3d sigma = half_extent_sigma_m({view_of(points)});
  // half the difference of two means of 121 points each
  EXPECT_NEAR(sigma.z(), point_sigma_m / std::sqrt(2.0 * 121.0 + compactness * compactness), 1e-6);
  EXPECT_NEAR(sigma.x(), point_sigma_m / compactness, 1e-4);
}

TEST(ShapeProblem, RecoversShapeAndPose) {
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool back : {false, true})
      for (const auto& point : face_points(axis, back)) points.push_back(point);
  const std::vector<BodyView> views{view_of(points)};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.pretranslate(Eigen::Vector3d(0.001, -0.002, box_depth_m + 0.002));
  RoundedBody start = box;
  start.inner_m *= 0.9;
  ShapeProblem problem(views, start, {pose}, fine_loss_width_m, 0.0);
  problem.solve();
  EXPECT_LT((problem.body().half_extents_m() - box.half_extents_m()).norm(), 1e-4);
  EXPECT_LT((problem.poses()[0].translation() - box_depth_m * Eigen::Vector3d::UnitZ()).norm(),
            1e-4);
}

}  // namespace
}  // namespace touchtrace::label
