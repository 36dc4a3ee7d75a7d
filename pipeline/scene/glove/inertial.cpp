#include "pipeline/scene/glove/inertial.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/random.h"
#include "pipeline/scene/base/rotation.h"
#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double max_reading = 32767.0;
constexpr double max_jitter_share = 0.5;  // of a period, so that samples arrive in order

Vector3d normals(RandomStream& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// Rounds to 16 bits of +- range and clamps.
Vector3d quantized(const Vector3d& value, double range) {
  return (value * (max_reading / range))
             .array()
             .round()
             .cwiseMax(-max_reading)
             .cwiseMin(max_reading) *
         (range / max_reading);
}

/// State of the unit, world frame.
struct UnitState {
  Quaterniond orientation;
  Vector3d velocity_m_per_s;
};

UnitState state_at(const std::vector<SceneSample>& samples, const Vector3d& place_m,
                   double time_s) {
  const double at = (time_s - samples.front().time_s) * sample_rate_hz;
  const auto i = std::min(static_cast<std::size_t>(std::max(0.0, at)),
                          std::max<std::size_t>(2, samples.size()) - 2);
  const double w = at - static_cast<double>(i);
  const auto velocity = [&](const RigidState& hand) -> Vector3d {
    return hand.velocity_m_per_s +
           hand.angular_velocity_rad_per_s.cross(hand.orientation * place_m);
  };
  const RigidState &a = samples[i].hand, &b = samples[i + 1].hand;
  return {a.orientation.slerp(w, b.orientation), (1.0 - w) * velocity(a) + w * velocity(b)};
}

/// Means over an interval, in the unit's frame.
struct Motion {
  Vector3d specific_force_m_per_s2, angular_velocity_rad_per_s;
};

Motion mean_motion(const UnitState& from, const UnitState& to, double interval_s) {
  const Eigen::AngleAxisd rotation(from.orientation.conjugate() * to.orientation);
  const Quaterniond mean = from.orientation.slerp(0.5, to.orientation);
  const Vector3d force = (to.velocity_m_per_s - from.velocity_m_per_s) / interval_s +
                         gravity_m_per_s2 * Vector3d::UnitZ();
  return {mean.conjugate() * force, rotation.angle() / interval_s * rotation.axis()};
}

class InertialUnit {
 public:
  InertialUnit(const SceneOptions& options, int clip)
      : p_(options.parameters.inertial),
        random_(options.seed, fmt::format("inertial unit clip {}", clip)) {
    RandomStream instance(static_cast<std::uint64_t>(options.glove), "inertial unit");
    force_offset_ = p_.force_offset_g * gravity_m_per_s2 * normals(instance);
    rate_offset_ = p_.rate_offset_deg_per_s * radians_per_degree * normals(instance);
  }

  Quaterniond first_estimate(const Quaterniond& orientation) {
    const Vector3d up = orientation.conjugate() * Vector3d::UnitZ();
    const Quaterniond heading =
        rotation_from_vector(random_.uniform(0.0, 2 * std::numbers::pi) * Vector3d::UnitZ());
    return heading * orientation *
           rotation_from_vector(up.cross(force_offset_) / -gravity_m_per_s2);
  }

  Motion read(const Motion& truth) {
    const double bandwidth = std::sqrt(0.5 * p_.rate_hz);
    const double force_noise = p_.force_noise_g * gravity_m_per_s2 * bandwidth,
                 rate_noise = p_.rate_noise_deg_per_s * radians_per_degree * bandwidth;
    const Vector3d force =
        truth.specific_force_m_per_s2 + force_offset_ + force_noise * normals(random_);
    const Vector3d rate =
        truth.angular_velocity_rad_per_s + rate_offset_ + rate_noise * normals(random_);
    return {quantized(force, p_.force_range_g * gravity_m_per_s2),
            quantized(rate, p_.rate_range_deg_per_s * radians_per_degree)};
  }

  Quaterniond updated_estimate(const Quaterniond& estimate, const Motion& read,
                               double interval_s) const {
    const Vector3d up = estimate.conjugate() * Vector3d::UnitZ();
    const Vector3d correction =
        read.specific_force_m_per_s2.normalized().cross(up) / p_.levelling_s;
    return (estimate *
            rotation_from_vector(interval_s * (read.angular_velocity_rad_per_s + correction)))
        .normalized();
  }

  double arrival_delay_s(const GloveClock& clock) {
    const double jitter_s = -clock.jitter_s * std::log1p(-random_.uniform());
    return clock.latency_s + std::min(jitter_s, max_jitter_share / p_.rate_hz);
  }

 private:
  InertialParameters p_;
  RandomStream random_;
  Vector3d force_offset_, rate_offset_;
};

void append(std::vector<float>& values, const Vector3d& v) {
  for (double x : v) values.push_back(static_cast<float>(x));
}

}  // namespace

InertialStream sense_inertia(const std::vector<SceneSample>& samples, const SceneOptions& options,
                             int clip) {
  const InertialParameters& p = options.parameters.inertial;
  const GloveClock clock = glove_clock(options);
  // The unit shares the glove's clock.
  const double period_s = GloveInfo{}.rate_hz / (p.rate_hz * clock.rate_hz);
  const Vector3d place_m(p.place_x_m, 0.0, p.place_z_m);
  InertialStream stream;
  stream.rate_hz = p.rate_hz;
  stream.position_m = {place_m.x(), place_m.y(), place_m.z()};
  if (samples.size() < 2) return stream;
  InertialUnit unit(options, clip);
  auto number = static_cast<std::uint64_t>(
      std::ceil((samples.front().time_s - clock.first_frame_s) / period_s));
  double time_s = clock.first_frame_s + static_cast<double>(number) * period_s;
  UnitState before = state_at(samples, place_m, time_s);
  Quaterniond estimate = unit.first_estimate(before.orientation);
  while (time_s + period_s <= samples.back().time_s) {
    time_s = clock.first_frame_s + static_cast<double>(++number) * period_s;
    const UnitState now = state_at(samples, place_m, time_s);
    const Motion read = unit.read(mean_motion(before, now, period_s));
    estimate = unit.updated_estimate(estimate, read, period_s);
    before = now;
    stream.sequence.push_back(number);
    stream.host_time_s.push_back(time_s + unit.arrival_delay_s(clock));
    append(stream.specific_force_m_per_s2, read.specific_force_m_per_s2);
    append(stream.angular_velocity_rad_per_s, read.angular_velocity_rad_per_s);
    for (double q : {estimate.w(), estimate.x(), estimate.y(), estimate.z()})
      stream.orientation_wxyz.push_back(static_cast<float>(q));
  }
  return stream;
}

}  // namespace touchtrace::scene
