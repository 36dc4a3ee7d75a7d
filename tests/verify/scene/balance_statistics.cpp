#include "tests/verify/scene/balance_statistics.h"

#include <fmt/core.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "pipeline/scene/person/person_simulation.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double slow_min_hz = 0.25, slow_max_hz = 2.5, max_hz = 10.0;

/// Time series of one clip, one row per control interval.
struct BalanceClip {
  std::vector<Vector2d> lean, hand_m, hand_m_per_s, pressure_m;  ///< lean, pressure: hand's frame
  std::vector<Vector3d> moment_nm, needed_nm;                    ///< object's frame
  bool lost = false;
};

Vector2d center_of_pressure(const World& world) {
  Vector2d sum = Vector2d::Zero();
  double force = 0.0;
  for (std::size_t i = 0; i < world.model().taxels.size(); ++i) {
    if (world.model().taxels[i].finger >= 0) continue;
    sum += world.contact().force_n()[i] * world.model().taxels[i].position_m.head<2>();
    force += world.contact().force_n()[i];
  }
  return force > 0.0 ? Vector2d(sum / force) : sum;
}

Vector3d in_body(const RigidState& body, const Vector3d& world) {
  return body.orientation.conjugate() * world;
}

/// Appends the moments about the foot's centre: that of the hand, and that which the change of
/// momentum needs.
void add_moments(const World& world, const RigidState& before, BalanceClip& clip) {
  const ObjectSpec& spec = world.spec();
  const RigidState& now = world.object;
  const Vector3d axis = spec.hold.from_palm, up_to_mass = -spec.hold.center_m.dot(axis) * axis;
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - axis * axis.dot(v); };
  clip.moment_nm.push_back(across(world.contact().torque_on_object_nm() +
                                  up_to_mass.cross(world.contact().force_on_object_n())));
  const Vector3d acceleration =
      (now.velocity_m_per_s - before.velocity_m_per_s) / control_interval_s +
      gravity_m_per_s2 * Vector3d::UnitZ();
  const auto momentum = [&](const RigidState& body) -> Vector3d {
    return body.orientation * (spec.inertia_kg_m2 * in_body(body, body.angular_velocity_rad_per_s));
  };
  const Vector3d turning = in_body(now, momentum(now) - momentum(before)) / control_interval_s;
  clip.needed_nm.push_back(
      across(turning + up_to_mass.cross(spec.mass_kg * in_body(now, acceleration))));
}

BalanceClip balance_clip(const SceneOptions& options, int number) {
  PersonSimulation simulation(options, fmt::format("balance statistics {}", number), 0.0);
  BalanceClip clip;
  clip.lost = !simulation.grasp();
  const World& world = simulation.world();
  for (long i = 0; i < std::lround(options.clip_s * sample_rate_hz) && !clip.lost; ++i) {
    const RigidState before = world.object;
    simulation.advance();
    const Vector3d up = world.object.orientation * world.spec().hold.from_palm;
    clip.lean.push_back(in_body(world.hand, up).head<2>());
    clip.hand_m.push_back(world.hand.position_m.head<2>());
    clip.hand_m_per_s.push_back(world.hand.velocity_m_per_s.head<2>());
    clip.pressure_m.push_back(center_of_pressure(world));
    add_moments(world, before, clip);
    clip.lost = simulation.is_lost();
  }
  return clip;
}

/// Power of both components between two frequencies, by a discrete Fourier transform.
double power(const std::vector<Vector2d>& values, double low_hz, double high_hz) {
  const double seconds = static_cast<double>(values.size()) * control_interval_s;
  double sum = 0.0;
  for (double k = std::ceil(low_hz * seconds); k < high_hz * seconds; ++k) {
    Eigen::Vector2cd wave = Eigen::Vector2cd::Zero();
    for (std::size_t i = 0; i < values.size(); ++i)
      wave += std::polar(1.0, -2.0 * std::numbers::pi * k * static_cast<double>(i) /
                                  static_cast<double>(values.size())) *
              values[i];
    sum += wave.squaredNorm();
  }
  return sum;
}

Vector2d mean_of(const std::vector<Vector2d>& values) {
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Sums over all clips.
struct BalanceSums {
  double count = 0.0, lean2 = 0.0, hand2 = 0.0, slow = 0.0, all = 0.0, moment2 = 0.0, off2 = 0.0;
  double lean_lean = 0.0, lean_pressure = 0.0, pressure_pressure = 0.0;  ///< about their means

  void add(const BalanceClip& clip, BalanceStatistics& s) {
    const Vector2d home = mean_of(clip.hand_m), lean = mean_of(clip.lean),
                   pressure = mean_of(clip.pressure_m);
    for (std::size_t i = 0; i < clip.lean.size(); ++i) {
      const double away = (clip.hand_m[i] - home).norm();
      s.lean_max_rad = std::max(s.lean_max_rad, clip.lean[i].norm());
      s.hand_max_m = std::max(s.hand_max_m, away);
      lean2 += clip.lean[i].squaredNorm(), hand2 += away * away, ++count;
      const Vector2d l = clip.lean[i] - lean, p = clip.pressure_m[i] - pressure;
      lean_lean += l.squaredNorm(), lean_pressure += l.dot(p), pressure_pressure += p.squaredNorm();
      moment2 += clip.moment_nm[i].squaredNorm();
      off2 += (clip.moment_nm[i] - clip.needed_nm[i]).squaredNorm();
    }
    slow += power(clip.hand_m_per_s, slow_min_hz, slow_max_hz);
    all += power(clip.hand_m_per_s, 0.0, max_hz);
  }
};

}  // namespace

BalanceStatistics balance_statistics(const SceneOptions& options, int clips) {
  BalanceStatistics s;
  BalanceSums sums;
  for (int i = 0; i < clips; ++i) {
    const BalanceClip clip = balance_clip(options, i);
    s.lost_share += (clip.lost ? 1.0 : 0.0) / clips;
    if (!clip.lean.empty()) sums.add(clip, s);
  }
  s.lean_rms_rad = std::sqrt(sums.lean2 / sums.count);
  s.hand_rms_m = std::sqrt(sums.hand2 / sums.count);
  s.slow_share = sums.slow / sums.all;
  s.moment_rms_nm = std::sqrt(sums.moment2 / sums.count);
  s.moment_residual = std::sqrt(sums.off2 / sums.moment2);
  s.pressure_m_per_rad = sums.lean_pressure / sums.lean_lean;
  s.pressure_r2 =
      sums.lean_pressure * sums.lean_pressure / (sums.lean_lean * sums.pressure_pressure);
  return s;
}

}  // namespace touchtrace::scene
