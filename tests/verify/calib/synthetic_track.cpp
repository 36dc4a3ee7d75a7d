#include "tests/verify/calib/synthetic_track.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"

namespace touchtrace {
namespace {

constexpr double standard_gravity = 9.81;
constexpr double ball_drag_per_m = 0.126;  // half of air's density * .45 * area / 2.7 g

/// Appends segments to a motion.
class MotionWriter {
 public:
  bool shorter_than(double seconds) const { return motion_.seconds() < seconds; }
  double now_s() const { return motion_.seconds(); }
  const Eigen::Vector3d& position() const { return motion_.position_m.back(); }
  const Eigen::Vector3d& velocity() const { return motion_.velocity_m_per_s.back(); }

  MotionWriter() {
    motion_.position_m.push_back(Eigen::Vector3d::Zero());
    motion_.velocity_m_per_s.push_back(Eigen::Vector3d::Zero());
  }

  /// Minimum-jerk motion from rest to rest at `goal`.
  void reach(const Eigen::Vector3d& goal, double seconds) {
    const Eigen::Vector3d start = position(), way = goal - start;
    const int steps = step_count(seconds);
    for (int i = 1; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps, duration = steps * SyntheticMotion::step_s;
      add(start + way * s * s * s * (10.0 + s * (-15.0 + 6.0 * s)),
          way * 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration);
    }
  }

  /// Half-sine acceleration to the velocity `goal`.
  void accelerate(const Eigen::Vector3d& goal, double seconds) {
    const Eigen::Vector3d start = position(), from = velocity(), change = goal - from;
    const int steps = step_count(seconds);
    const double duration = steps * SyntheticMotion::step_s;
    for (int i = 1; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      add(start + duration * (from * s + change * 0.5 * (s - std::sin(M_PI * s) / M_PI)),
          from + change * 0.5 * (1.0 - std::cos(M_PI * s)));
    }
  }

  /// Flight under gravity and drag until the ball falls below `height` (y points down); then a hit
  /// gives it the velocity `next`.
  void bounce(double height, const Eigen::Vector3d& next) {
    const Eigen::Vector3d g(0.0, standard_gravity, 0.0);
    const auto acceleration = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(g - ball_drag_per_m * v.norm() * v);
    };
    const double release = now_s(), h = SyntheticMotion::step_s;
    do {
      const Eigen::Vector3d middle = velocity() + 0.5 * h * acceleration(velocity());
      add(position() + h * middle, velocity() + h * acceleration(middle));
    } while (velocity().y() < 0.0 || position().y() < height);
    motion_.velocity_m_per_s.back() = next;
    motion_.flights.push_back({release, now_s()});
  }

  /// Flight under gravity, then a landing that keeps the fraction `kept` of the velocity.
  void fly(double seconds, double kept) {
    const Eigen::Vector3d start = position(), from = velocity(), g(0.0, standard_gravity, 0.0);
    const double release = now_s();
    for (int i = 1, steps = step_count(seconds); i <= steps; ++i) {
      const double t = i * SyntheticMotion::step_s;
      add(start + from * t + 0.5 * g * t * t, from + g * t);
    }
    motion_.velocity_m_per_s.back() *= kept;
    motion_.flights.push_back({release, now_s()});
  }

  SyntheticMotion take() { return std::move(motion_); }

 private:
  static int step_count(double seconds) {
    return std::max(1, static_cast<int>(std::lround(seconds / SyntheticMotion::step_s)));
  }
  void add(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity) {
    motion_.position_m.push_back(position);
    motion_.velocity_m_per_s.push_back(velocity);
  }

  SyntheticMotion motion_;
};

Eigen::Vector3d at(const std::vector<Eigen::Vector3d>& values, double time_s) {
  const double steps =
      std::clamp(time_s / SyntheticMotion::step_s, 0.0, static_cast<double>(values.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(steps), values.size() - 2);
  const double part = steps - static_cast<double>(i);
  return values[i] + part * (values[i + 1] - values[i]);
}

}  // namespace

Eigen::Vector3d SyntheticMotion::position_at(double time_s) const { return at(position_m, time_s); }
Eigen::Vector3d SyntheticMotion::velocity_at(double time_s) const {
  return at(velocity_m_per_s, time_s);
}

SyntheticMotion synthetic_wave(double seconds, std::uint64_t seed) {
  RandomStream random(seed, "synthetic wave");
  MotionWriter writer;
  while (writer.shorter_than(seconds)) {
    const double stroke_s = random.uniform(0.11, 0.45);
    // an arm reaches 30 m/s^2; a stroke of length L in T peaks at 5.77 L / T^2
    const double amplitude =
        std::min(random.uniform(0.02, 0.08), 0.5 * 30.0 * stroke_s * stroke_s / 5.77);
    const Eigen::Vector3d way(1.0, random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    for (int side = 1, strokes = 4 + static_cast<int>(random.below(12)); strokes > 0;
         --strokes, side = -side)
      writer.reach(side * amplitude * way, stroke_s);
  }
  return writer.take();
}

SyntheticMotion synthetic_throw(double seconds, std::uint64_t seed) {
  RandomStream random(seed, "synthetic throw");
  MotionWriter writer;
  while (writer.shorter_than(seconds)) {
    const double speed = std::sqrt(2.0 * standard_gravity * random.uniform(0.10, 0.42));
    const Eigen::Vector3d aside(random.uniform(-0.1, 0.1), 0.0, random.uniform(-0.1, 0.1));
    writer.reach(Eigen::Vector3d(0.0, random.uniform(0.05, 0.12), 0.0), random.uniform(0.25, 0.4));
    writer.accelerate(aside - speed * Eigen::Vector3d::UnitY(), random.uniform(0.12, 0.2));
    writer.fly(2.0 * speed / standard_gravity * random.uniform(0.9, 1.1),
               random.uniform(0.35, 0.6));
    writer.accelerate(Eigen::Vector3d::Zero(), random.uniform(0.1, 0.2));
    writer.reach(Eigen::Vector3d::Zero(), random.uniform(0.4, 0.8));
  }
  return writer.take();
}

SyntheticMotion synthetic_pingpong(double seconds, std::uint64_t seed) {
  RandomStream random(seed, "synthetic pingpong");
  MotionWriter writer;
  const auto aim = [&]() -> Eigen::Vector3d {
    const double speed = std::sqrt(2.0 * standard_gravity * random.uniform(0.12, 0.42));
    return Eigen::Vector3d(random.uniform(-0.2, 0.2), -speed, random.uniform(-0.2, 0.2)) -
           0.5 * Eigen::Vector3d(writer.position().x(), 0.0, writer.position().z());
  };
  writer.accelerate(aim(), 0.15);
  while (writer.shorter_than(seconds)) writer.bounce(random.uniform(-0.05, 0.05), aim());
  return writer.take();
}

Track measure(const SyntheticMotion& motion, double rate_hz, double sigma_m, std::uint64_t seed) {
  RandomStream random(seed, "synthetic measurement");
  Track track;
  const auto frames = static_cast<std::size_t>(motion.seconds() * rate_hz) + 1;
  for (std::size_t i = 0; i < frames; ++i) {
    const double time_s = static_cast<double>(i) / rate_hz;
    Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    track.push_back(
        {time_s, motion.position_at(time_s) + sigma_m * noise, Eigen::Vector3d::Constant(sigma_m)});
  }
  return track;
}

Track rescaled(const Track& track, double meters, double seconds, double origin_s) {
  Track result;
  for (const auto& point : track)
    result.push_back(
        {origin_s + seconds * point.time_s, meters * point.position_m, meters * point.sigma_m});
  return result;
}

}  // namespace touchtrace
