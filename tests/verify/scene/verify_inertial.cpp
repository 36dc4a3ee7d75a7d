#include <fmt/core.h>

#include <cmath>

#include "pipeline/scene/base/rotation.h"
#include "pipeline/scene/camera/exposure.h"
#include "pipeline/scene/glove/glove.h"
#include "pipeline/scene/glove/inertial.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double num_sigmas = 5.0;

SceneOptions without_offsets() {
  SceneOptions options;
  options.parameters.inertial.force_offset_g = 0.0;
  options.parameters.inertial.rate_offset_deg_per_s = 0.0;
  return options;
}

Vector3d row(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// A hand at rest in a general orientation.
std::vector<SceneSample> still_samples() {
  std::vector<SceneSample> samples(5000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time_s = static_cast<double>(i) / sample_rate_hz;
    samples[i].hand.orientation = Eigen::AngleAxisd(0.9, Vector3d(0.5, -0.3, 0.8).normalized());
  }
  return samples;
}

/// The mean specific force of a hand at rest is g upwards.
void verify_rest(const std::function<void(Figure)>& emit) {
  const SceneOptions options = without_offsets();
  const InertialParameters& p = options.parameters.inertial;
  const auto samples = still_samples();
  const InertialStream stream = sense_inertia(samples, options, 0);
  const std::size_t count = stream.sequence.size();
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i)
    mean += row(stream.specific_force_m_per_s2, i) / static_cast<double>(count);
  const Vector3d error =
      samples.front().hand.orientation * mean - gravity_m_per_s2 * Vector3d::UnitZ();
  const double of_mean =
      p.force_noise_g * gravity_m_per_s2 * std::sqrt(0.5 * p.rate_hz / static_cast<double>(count));
  const double step = p.force_range_g * gravity_m_per_s2 / 32767.0;
  emit(at_most("inertial unit at rest: specific force against g", error.norm(), "m/s^2",
               num_sigmas * std::sqrt(3.0) * of_mean + step));
}

/// The integrated angular velocity is the rotation of the hand, up to the random walk of its noise.
void verify_rotation(const std::function<void(Figure)>& emit) {
  SceneOptions options = without_offsets();
  options.inertial_unit = true;
  const InertialParameters& p = options.parameters.inertial;
  const ClipMotion motion = simulate_clip(options, 0, 0.0);
  const InertialStream& stream = *motion.glove.inertial;
  const GloveClock clock = glove_clock(options);
  const double period_s = 15.0 / (p.rate_hz * clock.rate_hz);
  const auto truth_at = [&](std::uint64_t number) {
    const double time_s = clock.first_frame_s + static_cast<double>(number) * period_s;
    return sample_at(motion, time_s).hand.orientation;
  };
  Quaterniond integral = Quaterniond::Identity();
  for (std::size_t i = 0; i < stream.sequence.size(); ++i) {
    const Vector3d turn = period_s * row(stream.angular_velocity_rad_per_s, i);
    integral = integral * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  const Quaterniond truth =
      truth_at(stream.sequence.front() - 1).conjugate() * truth_at(stream.sequence.back());
  const auto count = static_cast<double>(stream.sequence.size());
  const double step = p.rate_range_deg_per_s / 32767.0 / std::sqrt(12.0);
  const double walk_deg =
      std::sqrt(0.5 * p.rate_noise_deg_per_s * p.rate_noise_deg_per_s * count * period_s +
                step * step * period_s * period_s * count);
  emit(at_most("inertial unit, wave: integrated rotation after a clip",
               truth.angularDistance(integral) / radians_per_degree, "deg",
               num_sigmas * std::sqrt(3.0) * walk_deg));
}

}  // namespace

void verify_inertial(const std::function<void(Figure)>& emit) {
  verify_rest(emit);
  verify_rotation(emit);
}

}  // namespace touchtrace::scene
