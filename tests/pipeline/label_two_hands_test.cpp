// Other bodies of the hand's colour: the other hand, a face, the bare arm.
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/label.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::staged {
namespace {

using Eigen::Vector3d;

constexpr double hand_radius_m = 0.05, wrong_m = 0.06, bare_arm_half_m = 0.03;
const Vector3d ball_from_hand(0.0, -0.07, -0.02);

/// Blue discs before a torso and a wall: the hand, which holds a red ball, and others.
struct Scene {
  struct Disc {
    Vector3d centre_m;
    double radius_m;
  };

  std::function<Vector3d(double time_s)> hand_m;
  std::function<std::vector<Disc>(double time_s)> others;
  std::function<bool(double time_s)> shows_hand = [](double) { return true; };
  bool shows_ball_without_hand = false;
  bool has_bare_arm = false;  ///< below the hand, of its colour

  RgbdFrame render(double time_s, bool person) const {
    const Vector3d hand = hand_m(time_s), ball = hand + ball_from_hand;
    auto discs = others(time_s);
    if (shows_hand(time_s)) discs.push_back({hand, hand_radius_m});
    return render_pixels([&](const Vector3d& ray, Pixel& pixel) {
      if (!person) return;
      if (std::abs(ray.x()) < 0.3) pixel.show(1.5, skin);
      for (const auto& [centre_m, radius_m] : discs)
        if (is_on_disc(ray, centre_m, radius_m)) pixel.show(centre_m.z(), blue);
      const Vector3d on_arm = ray * hand.z() - hand;
      if (has_bare_arm && std::abs(on_arm.x()) < bare_arm_half_m && on_arm.y() > 0.0)
        pixel.show(hand.z(), blue);
      if (shows_hand(time_s) || shows_ball_without_hand) pixel.show(ball_depth_m(ray, ball), red);
    });
  }
};

struct HandLabels {
  double wrong = 0.0, flagged = 0.0;  ///< fractions of the labels: wrong and not flagged; flagged
  double max_error_m = 0.0;           ///< of those that are not flagged
};

/// Labels the scene at its camera frames, with boxes in the first one.
HandLabels label(const Scene& scene) {
  auto options = component_options();
  options.no_flights = true;
  const auto labels =
      label_recording(camera_recording(box_around(scene.hand_m(0.0), hand_radius_m),
                                       box_around(scene.hand_m(0.0) + ball_from_hand, 0.036)),
                      frame_source(scene), calibration(), options);
  const auto frames = static_cast<double>(labels.time_s.size());
  HandLabels result;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    const Vector3d position(labels.hand.position_m.data() + 3 * i);
    const double error_m = (position - scene.hand_m(labels.time_s[i])).norm();
    const bool is_flagged = labels.hand.quality[i] != quality_good;
    result.flagged += is_flagged / frames;
    if (is_flagged) continue;
    result.wrong += !(error_m < wrong_m) / frames;
    result.max_error_m = std::max(result.max_error_m, error_m);
  }
  return result;
}

/// Distance from the middle of the picture, which shrinks to `nearest_m` at 3 s and grows again.
double approach_m(double time_s, double nearest_m) {
  return nearest_m + 0.12 * std::pow(std::cos(M_PI * time_s / seconds), 2);
}

TEST(LabelTwoHands, HandsThatTouchAndPartKeepTheirIdentity) {
  Scene scene;
  scene.hand_m = [](double t) { return Vector3d(-approach_m(t, 0.05), 0.02, 1.1); };
  scene.others = [](double t) -> std::vector<Scene::Disc> {
    return {{Vector3d(approach_m(t, 0.055), 0.03, 1.11), 0.055}};
  };
  const auto labels = label(scene);
  EXPECT_EQ(labels.wrong, 0.0);
  EXPECT_LE(labels.flagged, 0.05);
  EXPECT_LT(labels.max_error_m, 0.03);
}

TEST(LabelTwoHands, HandsThatCrossKeepTheirIdentity) {
  Scene scene;
  const auto cross = [](double t) { return 0.18 * std::cos(M_PI * t / seconds); };
  scene.hand_m = [=](double t) { return Vector3d(-cross(t), 0.02, 1.0); };
  scene.others = [=](double t) -> std::vector<Scene::Disc> {
    return {{Vector3d(cross(t), 0.03, 1.12), 0.055}};
  };
  const auto labels = label(scene);
  EXPECT_EQ(labels.wrong, 0.0);
  EXPECT_LE(labels.flagged, 0.05);
}

/// The other hand's fingers are in the object's box, and the ball connects both hands.
TEST(LabelTwoHands, BothHandsMayHoldTheObjectInTheBoxFrame) {
  Scene scene;
  scene.hand_m = [](double t) { return Vector3d(-0.02 * t, 0.08, 1.1); };
  scene.others = [&](double t) -> std::vector<Scene::Disc> {
    return {{scene.hand_m(t) + Vector3d(0.06 * t, -0.11, 0.005), 0.055}};
  };
  const auto labels = label(scene);
  EXPECT_EQ(labels.wrong, 0.0);
  EXPECT_LE(labels.flagged, 0.05);
}

TEST(LabelTwoHands, AFaceIsNotTakenForAHiddenHand) {
  Scene scene;
  scene.hand_m = [](double t) { return Vector3d(-0.1 + 0.02 * std::sin(2.0 * t), 0.05, 1.1); };
  scene.others = [](double) -> std::vector<Scene::Disc> {
    return {{Vector3d(0.12, -0.15, 1.15), 0.07}};
  };
  scene.shows_hand = [](double t) { return t < 4.0; };
  const auto labels = label(scene);
  EXPECT_EQ(labels.wrong, 0.0);
  EXPECT_NEAR(labels.flagged, 2.0 / seconds, 0.05);
}

/// Both hands hide, and one comes out half-way between the places where they hid.
TEST(LabelTwoHands, AHandThatMayBeTheOtherOneIsFlagged) {
  constexpr double hides_s = 3.3, comes_out_s = 4.3;
  Scene scene;
  scene.hand_m = [](double) { return Vector3d(-0.12, 0.03, 1.1); };
  scene.others = [](double t) -> std::vector<Scene::Disc> {
    if (t > hides_s && t < comes_out_s) return {};
    return {{Vector3d(t < comes_out_s ? 0.12 : 0.0, 0.03, 1.1), hand_radius_m}};
  };
  scene.shows_hand = [](double t) { return t <= hides_s; };
  scene.shows_ball_without_hand = true;
  const auto labels = label(scene);
  EXPECT_EQ(labels.wrong, 0.0);
  EXPECT_NEAR(labels.flagged, 1.0 - hides_s / seconds, 0.05);
}

TEST(LabelTwoHands, AHandDoesNotSlideAlongItsBareArm) {
  Scene scene;
  scene.has_bare_arm = true;
  scene.hand_m = [](double t) { return Vector3d(0.0, 0.02 + 0.07 * std::sin(1.5 * t), 1.1); };
  scene.others = [](double) { return std::vector<Scene::Disc>(); };
  const auto labels = label(scene);
  EXPECT_LE(labels.flagged, 0.05);
  EXPECT_LT(labels.max_error_m, 0.04);
}

}  // namespace
}  // namespace touchtrace::staged
