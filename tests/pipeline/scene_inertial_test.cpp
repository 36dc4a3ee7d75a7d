#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/scene/glove/inertial.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {
namespace {

TEST(SceneInertial, MeasuresGravityAtRestAndIntegratesToTheRotation) {
  int rows = 0;
  verify_inertial([&](const Figure& figure) {
    ++rows;
    EXPECT_TRUE(figure.passes()) << figure.name << ' ' << figure.value;
  });
  EXPECT_EQ(rows, 2);
}

std::vector<SceneSample> spinning(double rad_per_s) {
  std::vector<SceneSample> samples(1000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time_s = static_cast<double>(i) / sample_rate_hz;
    samples[i].hand.orientation =
        Eigen::AngleAxisd(rad_per_s * samples[i].time_s, Eigen::Vector3d::UnitZ());
    samples[i].hand.angular_velocity_rad_per_s = rad_per_s * Eigen::Vector3d::UnitZ();
  }
  return samples;
}

// A unit at a distance r from the axis of rotation has the acceleration rate^2 r.
TEST(SceneInertial, MeasuresTheCentripetalAccelerationOfItsPosition) {
  SceneOptions options;
  options.parameters.inertial.force_offset_g = options.parameters.inertial.rate_offset_deg_per_s =
      0;
  const double rate = 6.0, lever_m = -options.parameters.inertial.place_x_m;
  const InertialStream stream = sense_inertia(spinning(rate), options, 0);
  ASSERT_GT(stream.sequence.size(), 150u);
  double force = 0.0, turning = 0.0;
  const auto count = static_cast<double>(stream.sequence.size());
  for (std::size_t i = 0; i < stream.sequence.size(); ++i)
    force += stream.specific_force_m_per_s2[3 * i] / count,
        turning += stream.angular_velocity_rad_per_s[3 * i + 2] / count;
  EXPECT_NEAR(force, rate * rate * lever_m, 0.005);  // means over a period are smaller by 6e-4
  EXPECT_NEAR(turning, rate, 1e-3);
}

TEST(SceneInertial, EstimatesTheVerticalWithinItsOffsets) {
  SceneOptions options;
  options.inertial_unit = true;
  const ClipMotion motion = simulate_clip(options, 0, 0.0);
  const InertialStream& stream = *motion.glove.inertial;
  const Eigen::Quaterniond truth = motion.samples.back().hand.orientation;
  const float* q = stream.orientation_wxyz.data() + stream.orientation_wxyz.size() - 4;
  const Eigen::Quaterniond told(q[0], q[1], q[2], q[3]);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_LT(std::acos((told.conjugate() * up).dot(truth.conjugate() * up)), 0.25);
  EXPECT_FALSE(simulate_clip(SceneOptions{}, 0, 0.0).glove.inertial.has_value());
}

}  // namespace
}  // namespace touchtrace::scene
