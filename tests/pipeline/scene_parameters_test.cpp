#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/recording/camera_schema.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/base/scene.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/camera_model.h"
#include "pipeline/scene/camera/visible.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/support/expect_error.h"

namespace touchtrace::scene {
namespace {

TEST(SceneParameters, EveryMemberHasOneRow) {
  SceneParameters parameters;
  std::set<const double*> numbers;
  std::set<std::string> names;
  for (const Parameter& row : parameter_registry()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.name.starts_with(row.group + "-")) << row.name;
    for (double& number : row.numbers(parameters))
      EXPECT_TRUE(numbers.insert(&number).second) << row.name;
  }
  EXPECT_EQ(numbers.size() * sizeof(double), sizeof(SceneParameters));
}

TEST(SceneParameters, DefaultsAreInRangeAndDescribed) {
  for (const Parameter& row : parameter_registry()) {
    SceneParameters parameters;
    scale_parameter(parameters, row, 0.5);
    set_parameter(parameters, row.name + "=" + value_text(row, {}));
    EXPECT_EQ(row.values(parameters), row.values()) << row.name;
    EXPECT_FALSE(row.description.empty()) << row.name;
    const bool has_value_source = !row.source.empty() && !row.source.ends_with("(form only)");
    EXPECT_TRUE(has_value_source || !row.reason.empty()) << row.name;
  }
}

/// The document's tables are those that the program prints.
TEST(SceneParameters, DocumentHasTheTableOfEveryGroup) {
  const std::string document =
      read_file(std::string(TOUCHTRACE_SOURCE_DIR) + "/pipeline/scene/PARAMETERS.md");
  std::set<std::string> groups;
  for (const Parameter& row : parameter_registry()) groups.insert(row.group);
  for (const std::string& group : groups)
    EXPECT_TRUE(document.find(markdown_table(group)) != std::string::npos)
        << group << ": replace its table by that of `touchtrace parameters --markdown`";
  const auto rows = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  long expected = 0, found = 0;
  for (const std::string& group : groups) expected += rows(markdown_table(group));
  for (std::size_t at = 0; (at = document.find("\n| ", at)) != std::string::npos; ++at) ++found;
  // "|---|" lines do not begin with "| ": one per table.
  EXPECT_EQ(found, expected - static_cast<long>(groups.size())) << "a table that is not generated";
}

TEST(SceneParameters, SettingsAreParsedAndValidated) {
  const SceneParameters p =
      parse_parameters({"glove-cross-talk=0.024,arm-mass=3", "wave-period=0.5:1.5"});
  EXPECT_EQ(p.glove.cross_talk, 0.024);
  EXPECT_EQ(p.arm.mass_kg, 3.0);
  EXPECT_EQ(p.wave.period_s, (Interval{0.5, 1.5}));
  for (const char* invalid :
       {"glove-cross-talk", "glove-cross-talk=", "glove-cross-talk=1e9", "glove-cross-talk=nan",
        "glove-cross-talk=0.1:0.2", "wave-period=1.5:0.5", "wave-period=0.5", "arm-mass=3kg"})
    EXPECT_THROW(parse_parameters({invalid}), Error) << invalid;
}

TEST(SceneParameters, MisspelledNameIsCorrected) {
  testing::expect_error([] { parse_parameters({"glove-crosstalk=0.024"}); }, "'glove-cross-talk'",
                        {});
}

TEST(SceneParameters, RelativeValuesScale) {
  EXPECT_EQ(parse_parameters({"glove-noise=x2"}).glove.noise_counts, 3.0);
  EXPECT_EQ(parse_parameters({"wave-amplitude=x0.5"}).wave.amplitude_m, (Interval{0.02, 0.08}));
  for (const char* factor : {"x", "x0", "x-1", "xnan", "xinf", "x2:3"})
    EXPECT_THROW(parse_parameters({std::string("glove-noise=") + factor}), Error) << factor;
}

TEST(SceneParameters, ScalingClampsToRangeAndKeepsBoxCentre) {
  SceneParameters p;
  scale_parameter(p, find_parameter("wave-amplitude"), 2.0);
  EXPECT_EQ(p.wave.amplitude_m, (Interval{0.08, 0.32}));
  scale_parameter(p, find_parameter("throw-catching-speed"), 2.0);
  EXPECT_EQ(p.toss.catching_speed, (Interval{0.7, 1.0}));
  scale_parameter(p, find_parameter("wave-place"), 0.5);
  EXPECT_NEAR(p.wave.place_m[0], -0.22, 1e-12);
  EXPECT_NEAR(p.wave.place_m[1], -0.06, 1e-12);
  EXPECT_NEAR(p.wave.place_m[5] - p.wave.place_m[4], 0.11, 1e-12);
}

ClipMotion simulate_wave(const std::vector<std::string>& settings, int glove = 1) {
  SceneOptions options;
  options.clip_s = 3.0;
  options.glove = glove;
  options.parameters = parse_parameters(settings);
  return simulate_clip(options, 0, 1.0);
}

TEST(SceneParameters, SettingsChangeTheSimulation) {
  const ClipMotion usual = simulate_wave({});
  const auto distance_m = [&](const ClipMotion& other) {
    return (usual.samples.back().hand.position_m - other.samples.back().hand.position_m).norm();
  };
  for (const char* setting :
       {"contact-stiffness=2e7", "arm-mass=4", "finger-damping=0.04", "grasp-place=0.01",
        "object-friction=0.5", "wave-replan-fraction=0.5:0.6", "hand-hollow=0.2",
        "hand-middle-joint=1.0"})
    EXPECT_GT(distance_m(simulate_wave({setting})), 0.0) << setting;
  const ClipMotion noisy = simulate_wave({"glove-noise=3"});
  EXPECT_EQ(distance_m(noisy), 0.0);
  EXPECT_NE(noisy.glove.counts, usual.glove.counts);
}

nlohmann::json describe_camera(const SceneParameters& parameters) {
  SceneOptions options;
  options.parameters = parameters;
  const RgbdCamera camera = make_camera(options);
  const DepthSensor& depth = camera.sensor;
  return {calibration_truth(camera),
          clock_truth(make_camera_clock(options)),
          color_attributes(camera_info(camera, options)).gravity,
          {camera.exposure_s, camera.color_noise_counts},
          {depth.baseline_m, depth.shift_sigma_px, depth.min_depth_m, depth.max_depth_m}};
}

TEST(SceneParameters, AllAndOnlyCameraParametersChangeTheCamera) {
  const nlohmann::json usual = describe_camera({});
  int num_changes = 0;
  for (const Parameter& row : parameter_registry()) {
    SceneParameters changed;
    scale_parameter(changed, row, 0.5);
    const bool differs = describe_camera(changed) != usual;
    EXPECT_EQ(differs, row.group == "camera") << row.name;
    num_changes += differs;
  }
  EXPECT_GE(num_changes, 25);
}

TEST(SceneParameters, RenderedHandHasTheShapeOfTheParameters) {
  SceneSample fist;
  fist.flexion_rad.fill(1.0);
  HandParameters stiff;
  stiff.last_joint_ratio = 0.1;
  const auto usual = hand_solids(fist), other = hand_solids(fist, hand_model(stiff));
  ASSERT_EQ(usual.size(), other.size());
  EXPECT_FALSE(std::ranges::equal(usual, other, [](const Solid& a, const Solid& b) {
    return a.body_from_shape.matrix() == b.body_from_shape.matrix();
  }));
}

TEST(SceneParameters, GloveInstanceChangesReadingsButNotMotion) {
  const ClipMotion one = simulate_wave({}), two = simulate_wave({}, 2);
  EXPECT_EQ(one.samples.back().hand.position_m, two.samples.back().hand.position_m);
  EXPECT_EQ(one.samples.back().grip_force_n, two.samples.back().grip_force_n);
  EXPECT_NE(one.glove.counts, two.glove.counts);
  EXPECT_NE(one.glove.host_time_s, two.glove.host_time_s);
  EXPECT_EQ(two.glove.info.name, "simulated glove 2");
}

TEST(SceneParameters, CameraFramesArriveInOrderWithLongJitter) {
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
