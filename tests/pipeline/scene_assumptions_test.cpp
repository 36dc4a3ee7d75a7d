#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/scene/base/assumptions.h"
#include "pipeline/scene/base/scene.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/camera_model.h"
#include "pipeline/scene/camera/visible.h"
#include "pipeline/scene/simulate/clip.h"

namespace touchtrace::scene {
namespace {

TEST(SceneAssumptions, EveryNumberOfTheSceneHasARow) {
  SceneParameters parameters;
  std::set<const double*> numbers;
  std::set<std::string> names;
  for (const Assumption& row : assumptions()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.name.starts_with(row.part + "-")) << row.name;
    for (double& number : row.numbers(parameters))
      EXPECT_TRUE(numbers.insert(&number).second) << row.name;
  }
  EXPECT_EQ(numbers.size() * sizeof(double), sizeof(SceneParameters));
}

TEST(SceneAssumptions, DefaultsAreAllowedAndSaidInFull) {
  for (const Assumption& row : assumptions()) {
    SceneParameters parameters;
    scale(parameters, row, 0.5);
    assume(parameters, row.name + "=" + value_text(row, {}));
    EXPECT_EQ(row.of(parameters), row.of({})) << row.name;
    EXPECT_FALSE(row.meaning.empty() || row.published.empty()) << row.name;
    EXPECT_FALSE(row.published.ends_with("no") && row.reason.empty()) << row.name;
  }
}

TEST(SceneAssumptions, AreTheTablesOfTheDocument) {
  const std::string document =
      read_file(std::string(TOUCHTRACE_SOURCE_DIR) + "/pipeline/scene/ASSUMPTIONS.md");
  std::set<std::string> parts;
  for (const Assumption& row : assumptions()) parts.insert(row.part);
  for (const std::string& part : parts)
    EXPECT_TRUE(document.find(markdown_table(part)) != std::string::npos)
        << part << ": put there what `touchtrace assumptions --markdown` prints";
}

TEST(SceneAssumptions, AreSetByNameWithinTheirRange) {
  const SceneParameters p = assumed({"glove-cross-talk=0.024,arm-mass=3", "wave-period=0.5:1.5"});
  EXPECT_EQ(p.glove.cross_talk, 0.024);
  EXPECT_EQ(p.arm.mass_kg, 3.0);
  EXPECT_EQ(p.wave.period_s, (Interval{0.5, 1.5}));
  for (const char* wrong :
       {"glove-cross-talk", "glove-cross-talk=", "glove-cross-talk=1e9", "glove-cross-talk=nan",
        "glove-cross-talk=0.1:0.2", "wave-period=1.5:0.5", "wave-period=0.5", "arm-mass=3kg"})
    EXPECT_THROW(assumed({wrong}), Error) << wrong;
}

TEST(SceneAssumptions, AWrongNameIsCorrected) {
  try {
    assumed({"glove-crosstalk=0.024"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.hint().find("'glove-cross-talk'"), std::string::npos) << error.hint();
  }
}

TEST(SceneAssumptions, AreScaledWithinTheirRangeAndPlacesAboutTheirMiddle) {
  SceneParameters p;
  scale(p, find_assumption("wave-amplitude"), 2.0);
  EXPECT_EQ(p.wave.amplitude_m, (Interval{0.08, 0.32}));
  scale(p, find_assumption("throw-catching-speed"), 2.0);
  EXPECT_EQ(p.toss.catching_speed, (Interval{0.7, 1.0}));
  scale(p, find_assumption("wave-place"), 0.5);
  EXPECT_NEAR(p.wave.place_m[0], -0.22, 1e-12);
  EXPECT_NEAR(p.wave.place_m[1], -0.06, 1e-12);
  EXPECT_NEAR(p.wave.place_m[5] - p.wave.place_m[4], 0.11, 1e-12);
}

ClipMotion clip_of(const std::vector<std::string>& settings, int glove = 1) {
  SceneOptions options;
  options.clip_s = 3.0;
  options.glove = glove;
  options.parameters = assumed(settings);
  return simulate_clip(options, 0, 1.0);
}

TEST(SceneAssumptions, ReachTheirPart) {
  const ClipMotion usual = clip_of({});
  const auto moved = [&](const ClipMotion& other) {
    return (usual.samples.back().hand.position_m - other.samples.back().hand.position_m).norm();
  };
  for (const char* setting : {"contact-stiffness=2e7", "arm-mass=4", "finger-damping=0.04",
                              "grasp-place=0.01", "object-friction=0.5", "wave-replanned=0.5:0.6",
                              "hand-hollow=0.2", "hand-middle-joint=1.0"})
    EXPECT_GT(moved(clip_of({setting})), 0.0) << setting;
  const ClipMotion noisy = clip_of({"glove-noise=3"});
  EXPECT_EQ(moved(noisy), 0.0);
  EXPECT_NE(noisy.glove.counts, usual.glove.counts);
}

/// All that a camera is made of.
nlohmann::json camera_of(const SceneParameters& parameters) {
  SceneOptions options;
  options.parameters = parameters;
  const RgbdCamera camera = make_camera(options);
  const DepthSensor& depth = camera.sensor;
  return {calibration_truth(camera),
          clock_truth(make_camera_clock(options)),
          camera_info(camera, options).gravity,
          {camera.exposure_s, camera.color_noise_counts},
          {depth.baseline_m, depth.shift_sigma_px, depth.nearest_m, depth.farthest_m}};
}

TEST(SceneAssumptions, EachOfTheCameraReachesIt) {
  const nlohmann::json usual = camera_of({});
  int reached = 0;
  for (const Assumption& row : assumptions()) {
    SceneParameters changed;
    scale(changed, row, 0.5);
    const bool differs = camera_of(changed) != usual;
    EXPECT_EQ(differs, row.part == "camera") << row.name;
    reached += differs;
  }
  EXPECT_GE(reached, 25);
}

TEST(SceneAssumptions, TheHandIsSeenAsItIs) {
  SceneSample fist;
  fist.flexion_rad.fill(1.0);
  HandParameters stiff;
  stiff.last_joint = 0.1;
  const auto usual = hand_solids(fist), other = hand_solids(fist, hand_model(stiff));
  ASSERT_EQ(usual.size(), other.size());
  EXPECT_FALSE(std::ranges::equal(usual, other, [](const Solid& a, const Solid& b) {
    return a.body_from_shape.matrix() == b.body_from_shape.matrix();
  }));
}

TEST(SceneAssumptions, AnotherGloveIsOnTheSameHand) {
  const ClipMotion one = clip_of({}), two = clip_of({}, 2);
  EXPECT_EQ(one.samples.back().hand.position_m, two.samples.back().hand.position_m);
  EXPECT_EQ(one.samples.back().grip_force_n, two.samples.back().grip_force_n);
  EXPECT_NE(one.glove.counts, two.glove.counts);
  EXPECT_NE(one.glove.host_time_s, two.glove.host_time_s);
  EXPECT_EQ(two.glove.info.name, "simulated glove 2");
}

/// However busy the host is.
TEST(SceneAssumptions, FramesOfTheCameraArriveInOrder) {
  SceneOptions options;
  options.parameters.camera.jitter_s *= 10.0;
  const CameraClock clock = make_camera_clock(options);
  double last_s = clock.arrival_s(0);
  for (std::uint64_t frame = 1; frame < 20000; ++frame) {
    const double now_s = clock.arrival_s(frame);
    ASSERT_GT(now_s, last_s) << frame;
    last_s = now_s;
  }
}

}  // namespace
}  // namespace touchtrace::scene
