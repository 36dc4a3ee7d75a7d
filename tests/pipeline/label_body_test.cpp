#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/label/estimate/learn_shape.h"
#include "pipeline/label/estimate/pose_tracker.h"
#include "pipeline/label/estimate/sphere_fit.h"
#include "tests/pipeline/drawn_body.h"

namespace touchtrace::label {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

const RoundedBody soap{{0.012, 0.025, 0.037}, 0.003}, ball{{0.0, 0.0, 0.0}, 0.028},
    can{{0.024, 0.024, 0.048}, 0.002, Core::cylinder};

/// The silhouette is sampled every drawn_pixel_m, so it is known to half of that. A plane face of
/// 100 points is known to a tenth of the noise; 2.5 of these.
constexpr double max_centre_error_m = 0.5 * drawn_pixel_m + 2.5 * drawn_noise_m / 10.0;
/// Extents and centres behind fingers, which hide parts of the silhouette.
constexpr double max_hidden_error_m = 0.003;
static_assert(max_hidden_error_m < drawn_pixel_m);

bool behind_fingers(double x, double) {
  constexpr double finger_m = 0.012, between_fingers_m = 0.028, first_m = -0.09;
  return std::fmod(x - first_m, between_fingers_m) < finger_m;
}

Isometry3d pose_of(double x_rad, double y_rad, double z_rad) {
  Isometry3d pose(AngleAxisd(x_rad, Vector3d::UnitX()) * AngleAxisd(y_rad, Vector3d::UnitY()) *
                  AngleAxisd(z_rad, Vector3d::UnitZ()));
  pose.pretranslate(drawn_at);
  return pose;
}

/// Views of a body that a hand turns.
std::vector<BodyView> views_of(const RoundedBody& body, const IsHidden& is_hidden, int count,
                               double depth_noise_m = drawn_noise_m) {
  std::vector<BodyView> views;
  for (int i = 0; i < count; ++i)
    views.push_back(draw(body, pose_of(0.9 * i, 0.4 * i, 0.7 * i), is_hidden,
                         static_cast<std::uint64_t>(i + 1), depth_noise_m));
  return views;
}

TEST(SurfaceDistance, OfRoundedBox) {
  const RoundedBody body{{0.01, 0.02, 0.03}, 0.005};
  EXPECT_NEAR(surface_distance(body, {0.025, 0.0, 0.0}).distance_m, 0.010, 1e-12);
  EXPECT_NEAR(surface_distance(body, {0.013, 0.024, 0.03}).distance_m, 0.0, 1e-12);  // 3-4-5
  EXPECT_NEAR(surface_distance(body, {-0.004, 0.0, 0.0}).distance_m, -0.011, 1e-12);
  EXPECT_NEAR(
      (surface_distance(body, {-0.013, -0.024, 0.0}).outward - Vector3d(-0.6, -0.8, 0.0)).norm(),
      0.0, 1e-12);
}

TEST(SurfaceDistance, OfRoundedCylinder) {
  const RoundedBody body{{0.02, 0.02, 0.03}, 0.005, Core::cylinder};
  const Vector3d side(0.6, -0.8, 0.0);
  EXPECT_NEAR(surface_distance(body, 0.035 * side).distance_m, 0.010, 1e-12);
  EXPECT_NEAR((surface_distance(body, 0.035 * side).outward - side).norm(), 0.0, 1e-12);
  EXPECT_NEAR((surface_distance(body, 0.015 * side).outward - side).norm(), 0.0, 1e-12);
  EXPECT_NEAR(surface_distance(body, 0.015 * side).distance_m, -0.010, 1e-12);
  const Vector3d at_the_rim = 0.023 * side + Vector3d(0.0, 0.0, -0.034);  // 3-4-5
  EXPECT_NEAR(surface_distance(body, at_the_rim).distance_m, 0.0, 1e-12);
  EXPECT_NEAR(
      (surface_distance(body, at_the_rim).outward - (0.6 * side - 0.8 * Vector3d::UnitZ())).norm(),
      0.0, 1e-12);
  EXPECT_NEAR(body.circumradius_m(), std::hypot(0.02, 0.03) + 0.005, 1e-12);
  EXPECT_NEAR(surface_distance(body, Vector3d::Zero()).outward.norm(), 1.0, 1e-12);
}

TEST(DeepestPoint, IsFoundUnlessTheSegmentMisses) {
  const auto deepest = deepest_point(soap, {0.01, -1.0, 0.0}, {0.01, 1.0, 0.0});
  ASSERT_TRUE(deepest);
  EXPECT_NEAR(surface_distance(soap, *deepest).distance_m, 0.01 - 0.015, 1e-4);
  EXPECT_FALSE(deepest_point(soap, {0.016, -1.0, 0.0}, {0.016, 1.0, 0.0}));
  EXPECT_FALSE(deepest_point(soap, {0.0, -1.0, 0.0}, {0.0, -0.1, 0.0}));  // ends before it
}

TEST(SymmetricRotationDistance, IgnoresTheBodysSymmetries) {
  const Eigen::Quaterniond from(AngleAxisd(1.1, Vector3d(0.6, 0.0, 0.8)));
  const auto distance = [&](Core core, double about_z, double about_x, double then_about_z) {
    const Eigen::Quaterniond rotation = AngleAxisd(about_z, Vector3d::UnitZ()) *
                                        AngleAxisd(about_x, Vector3d::UnitX()) *
                                        AngleAxisd(then_about_z, Vector3d::UnitZ());
    return symmetric_rotation_distance(core, from, from * rotation);
  };
  EXPECT_NEAR(distance(Core::box, M_PI, 0.0, 0.0), 0.0, 1e-7);
  EXPECT_NEAR(distance(Core::box, 0.0, M_PI, 0.2), 0.2, 1e-7);
  EXPECT_NEAR(distance(Core::box, 0.5 * M_PI, 0.0, 0.0), 0.5 * M_PI, 1e-7);
  EXPECT_NEAR(distance(Core::cylinder, 0.5 * M_PI, 0.0, 0.0), 0.0, 1e-7);
  EXPECT_NEAR(distance(Core::cylinder, 0.7, M_PI, -0.4), 0.0, 1e-7);
  EXPECT_NEAR(distance(Core::cylinder, 0.7, 0.3, 1.9), 0.3, 1e-7);
  EXPECT_NEAR(distance(Core::cylinder, 0.7, M_PI - 0.3, 1.9), 0.3, 1e-7);
}

TEST(FitBody, FindsABoxWithoutAStart) {
  for (int i = 0; i < 6; ++i) {
    const auto pose = pose_of(0.5 + 0.9 * i, 0.3 + 0.4 * i, 0.7 * i);
    const auto fit = fit_body_globally(draw(soap, pose, nothing_hidden), soap);
    EXPECT_LT((fit.centre_m() - drawn_at).norm(), max_centre_error_m) << "pose " << i;
  }
}

TEST(FitBody, IsNotBiasedByFingersInFrontOfABox) {
  const auto view = draw(soap, pose_of(0.6, 0.3, 1.2), behind_fingers);
  EXPECT_LT((fit_body_globally(view, soap).centre_m() - drawn_at).norm(), max_centre_error_m);
  // the centroid is on the surface; the smallest half extent is 15 mm
  EXPECT_GT((view.centroid_m() - drawn_at).norm(), 0.01);
}

TEST(FitBody, GivesLessInformationForAPartlyHiddenBody) {
  const auto pose = pose_of(0.6, 0.3, 1.2);
  const auto half = [](double x, double) { return x < 0.0; };
  const auto information = [&](const IsHidden& is_hidden) {
    return fit_body_globally(draw(soap, pose, is_hidden), soap).centre_information().trace();
  };
  EXPECT_GT(information(nothing_hidden), 1.3 * information(half));
}

TEST(PoseTracker, TracksARotatingBoxAndRecoversAfterAGap) {
  PoseTracker tracker(soap);
  constexpr double frame_s = 0.05, turn_rad = 0.25;
  for (int i = 0; i < 25; ++i) {
    if (i > 8 && i < 20) continue;  // unseen
    const auto view = draw(soap, pose_of(turn_rad * i, 0.3, 1.2), behind_fingers,
                           static_cast<std::uint64_t>(i + 1));
    const double since_s = i == 20 ? 12 * frame_s : frame_s;
    EXPECT_LT((tracker.update(view, since_s).centre_m() - drawn_at).norm(), max_hidden_error_m)
        << "frame " << i;
  }
}

TEST(PoseTracker, AcceptsTwoViewsAtTheSameTime) {
  PoseTracker tracker(soap);
  const auto view = draw(soap, pose_of(0.6, 0.3, 1.2), nothing_hidden);
  tracker.update(view, 0.0);
  EXPECT_LT((tracker.update(view, 0.0).centre_m() - drawn_at).norm(), max_centre_error_m);
}

/// View in which a hand wider than the body hides all but a strip.
BodyView strip_of(const Isometry3d& pose, std::uint64_t seed) {
  constexpr double strip_m = 0.008, hand_m = 0.055;
  auto view = draw(
      soap, pose, [](double x, double) { return std::abs(x) > strip_m; }, seed);
  std::erase_if(view.free_space_endpoints, [](const Eigen::Vector3f& end) {
    return std::abs(end.x() / end.z() * drawn_at.z() - drawn_at.x()) < hand_m;
  });
  return view;
}

/// Errors of the centre.
struct TrackingErrors {
  double first_view_m;              ///< of the first view, given that view alone
  std::vector<double> all_views_m;  ///< of every view, given all views
};

/// Tracks a body of which a strip is visible at first, later all.
TrackingErrors track_uncovered(const Isometry3d& pose) {
  constexpr int views = 12, covered = 8;
  PoseTracker tracker(soap);
  TrackingErrors result;
  for (int i = 0; i < views; ++i) {
    const auto seed = static_cast<std::uint64_t>(i + 1);
    const auto view = i < covered ? strip_of(pose, seed) : draw(soap, pose, nothing_hidden, seed);
    const double error_m = (tracker.update(view, 0.05).centre_m() - drawn_at).norm();
    if (i == 0) result.first_view_m = error_m;
  }
  for (const auto& fit : tracker.viterbi_path())
    result.all_views_m.push_back((fit.centre_m() - drawn_at).norm());
  return result;
}

/// A strip of a box on its edge looks like one of a box that lies flat.
TEST(PoseTracker, LaterViewsResolveEarlierAmbiguity) {
  const auto lying = track_uncovered(pose_of(0.0, M_PI / 2, 0.0)),
             on_edge = track_uncovered(pose_of(0.0, 0.0, 0.0));
  // the wrong of the two poses puts the centre off by the half extents' difference, 15 to 40 mm
  EXPECT_GT(std::max(lying.first_view_m, on_edge.first_view_m), 0.015);
  for (const auto& errors : {lying, on_edge}) {
    EXPECT_EQ(errors.all_views_m.size(), 12u);
    EXPECT_LT(std::ranges::max(errors.all_views_m), 0.005);
  }
}

/// Error of the centre in the last of some views, and its standard deviation from ambiguity.
std::pair<double, double> error_and_ambiguity_m(const std::vector<BodyView>& views) {
  PoseTracker tracker(soap);
  for (const auto& view : views) tracker.update(view, 0.05);
  const auto path = tracker.viterbi_path();
  return {(path.back().centre_m() - drawn_at).norm(),
          std::sqrt(tracker.ambiguity_m2(path).back().sum())};
}

TEST(PoseTracker, StatesTheSpreadOfPosesThatFitAlike) {
  std::vector<BodyView> lying, on_edge, whole;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    lying.push_back(strip_of(pose_of(0.0, M_PI / 2, 0.0), seed));
    on_edge.push_back(strip_of(pose_of(0.0, 0.0, 0.0), seed));
    whole.push_back(draw(soap, pose_of(0.6, 0.3, 1.2), nothing_hidden, seed));
  }
  double worst_m = 0.0;
  for (const auto& views : {lying, on_edge}) {
    const auto [error_m, ambiguity_m] = error_and_ambiguity_m(views);
    EXPECT_LT(error_m, 3.0 * ambiguity_m + max_centre_error_m);
    worst_m = std::max(worst_m, error_m);
  }
  EXPECT_GT(worst_m, 0.01);
  EXPECT_LT(error_and_ambiguity_m(whole).second, max_centre_error_m);
}

TEST(LearnShape, LearnsABox) {
  const auto shape = learn_shape(views_of(soap, behind_fingers, 16), 0.035, 1);
  ASSERT_TRUE(shape.body);
  EXPECT_EQ(shape.body->core, Core::box);
  Vector3d half = shape.body->half_extents_m();
  std::ranges::sort(half);
  EXPECT_LT((half - Vector3d(0.015, 0.028, 0.040)).cwiseAbs().maxCoeff(), max_hidden_error_m);
  EXPECT_LT(shape.unevenness_m, 2.0 * drawn_noise_m);
}

/// Shape learning takes depth for uncertain, so that extents come from silhouettes, which are
/// sampled every drawn_pixel_m.
constexpr double max_extent_error_m = 0.5 * drawn_pixel_m;

void expect_learnt_as_cylinder(const RoundedBody& body, const IsHidden& is_hidden,
                               double silhouette_m) {
  const auto shape = learn_shape(views_of(body, is_hidden, 16), silhouette_m, 2);
  ASSERT_TRUE(shape.body);
  EXPECT_EQ(shape.body->core, Core::cylinder);
  EXPECT_LT((shape.body->half_extents_m() - body.half_extents_m()).cwiseAbs().maxCoeff(),
            max_extent_error_m);
  EXPECT_LT(shape.unevenness_m, 1.5 * drawn_noise_m);
}

TEST(LearnShape, LearnsACanAsACylinder) { expect_learnt_as_cylinder(can, behind_fingers, 0.035); }

TEST(LearnShape, LearnsAPuckAsACylinder) {
  expect_learnt_as_cylinder({{0.036, 0.036, 0.0105}, 0.002, Core::cylinder}, behind_fingers, 0.033);
}

/// A thin bar fits a cylinder and a box with round edges alike.
TEST(LearnShape, LearnsABar) {
  const RoundedBody bar{{0.012, 0.012, 0.078}, 0.002, Core::cylinder};
  const auto shape = learn_shape(views_of(bar, nothing_hidden, 16), 0.08, 2);
  ASSERT_TRUE(shape.body);
  Vector3d half = shape.body->half_extents_m();
  std::ranges::sort(half);
  EXPECT_LT((half - bar.half_extents_m()).cwiseAbs().maxCoeff(), max_extent_error_m);
}

/// A view whose depth exaggerates the relief of the body by a factor, as errors do that
/// neighbouring pixels share.
BodyView with_relief(BodyView view, float factor) {
  const auto z_of = [](const Eigen::Vector3f& point) { return point.z(); };
  const float nearest_m = std::ranges::min(view.surface_points, {}, z_of).z();
  for (auto& point : view.surface_points)
    point *= (nearest_m + factor * (point.z() - nearest_m)) / point.z();
  return view;
}

/// Without the least noise ratio of shape learning: errors of 4 mm.
TEST(LearnShape, ToleratesDepthErrorsThatNeighboursShare) {
  const RoundedBody bar{{0.015, 0.015, 0.070}, 0.002, Core::cylinder};
  std::vector<BodyView> views;
  for (int i = 0; i < 12; ++i) {
    const auto pose = pose_of(M_PI / 2 + 0.3 * (i % 3 - 1), 0.0, 0.5 * i);
    views.push_back(
        with_relief(draw(bar, pose, behind_fingers, static_cast<std::uint64_t>(i + 1)), 1.3f));
  }
  const auto shape = learn_shape(views, 0.06, 2);
  ASSERT_TRUE(shape.body);
  EXPECT_LT((shape.body->half_extents_m() - bar.half_extents_m()).cwiseAbs().maxCoeff(),
            max_extent_error_m);
}

TEST(PoseTracker, TracksACanThatTurnsAndRolls) {
  PoseTracker tracker(can);
  for (int i = 0; i < 12; ++i) {
    const auto view = draw(can, pose_of(0.6 + 0.1 * i, 0.3, 1.5 * i), behind_fingers,
                           static_cast<std::uint64_t>(i + 1));
    EXPECT_LT((tracker.update(view, 0.05).centre_m() - drawn_at).norm(), max_centre_error_m)
        << "frame " << i;
  }
}

TEST(LearnShape, KeepsASphereForABall) {
  const auto shape = learn_shape(views_of(ball, behind_fingers, 16), 0.027, 1);
  EXPECT_FALSE(shape.body);
  EXPECT_NEAR(shape.radius_m, ball.radius_m, 0.0015);
}

/// Depth noise of a third of the radius hides the curvature, but not the silhouette.
TEST(LearnShape, UsesTheSilhouetteOfABallInDepthNoise) {
  const auto views = views_of(ball, nothing_hidden, 16, 0.008);
  const auto shape = learn_shape(views, 0.027, 1);
  EXPECT_FALSE(shape.body);
  EXPECT_NEAR(shape.radius_m, ball.radius_m, 0.0015);
  const Vector3d error = fit_sphere(views.front(), ball.radius_m).centre_m - drawn_at;
  EXPECT_LT(error.head<2>().norm(), 0.001);
  EXPECT_LT(std::abs(error.z()), 0.002);
}

/// Nothing shows the thickness of soap that never turns.
TEST(LearnShape, CentreSigmaCoversAThicknessThatNoViewShows) {
  std::vector<BodyView> lying;
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    lying.push_back(draw(soap, pose_of(M_PI / 2, 0.0, 0.0), nothing_hidden, seed));
  const auto shape = learn_shape(lying, 0.035, 2);
  ASSERT_TRUE(shape.body);
  const double error_m =
      (fit_body_globally(lying.front(), *shape.body).centre_m() - drawn_at).norm();
  EXPECT_GT(error_m, 0.01);
  EXPECT_LT(error_m, 2.0 * std::sqrt(3.0) * shape.centre_sigma_m);
  EXPECT_LT(learn_shape(views_of(soap, nothing_hidden, 8), 0.035, 2).centre_sigma_m,
            max_centre_error_m);
}

TEST(LearnShape, DoesNotDependOnThreads) {
  const auto views = views_of(soap, behind_fingers, 6);
  const auto one = learn_shape(views, 0.035, 1), three = learn_shape(views, 0.035, 3);
  ASSERT_TRUE(one.body && three.body);
  EXPECT_EQ(one.body->inner_m, three.body->inner_m);
  EXPECT_EQ(one.unevenness_m, three.unevenness_m);
}

TEST(LearnShape, IsFiniteForASinglePoint) {
  const BodyView view{Eigen::Vector3d::Zero(), {{0.0f, 0.0f, 1.0f}}, {}};
  EXPECT_TRUE(fit_body_globally(view, soap).centre_m().allFinite());
  EXPECT_TRUE(learn_shape({view}, 0.03, 1).radius_m > 0.0);
}

TEST(MedianDistance, IsOfThePointsFromTheSurface) {
  const RoundedBody body{{0.02, 0.02, 0.02}, 0.01};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 1.0;
  const std::vector<Eigen::Vector3f> points{
      {0.0f, 0.0f, 0.97f}, {0.0f, 0.0f, 0.92f}, {0.08f, 0.0f, 1.0f}};
  EXPECT_NEAR(median_distance_m(points, body, pose), 0.05, 1e-6);
}

}  // namespace
}  // namespace touchtrace::label
