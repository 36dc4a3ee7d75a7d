#include "pipeline/scene/base/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/scene/objects/sin_cos.h"

namespace touchtrace::scene {

double minimum_jerk_progress(double time_s, double start_s, double duration_s) {
  const double s = std::clamp((time_s - start_s) / duration_s, 0.0, 1.0);
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

Quintic::Quintic(const MotionState& from, const MotionState& to, double start_s, double duration_s)
    : from_(from), to_(to), start_s_(start_s), duration_s_(duration_s) {
  const double t = duration_s;
  const Eigen::Vector3d x = to.position_m - from.position_m - from.velocity_m_per_s * t -
                            0.5 * from.acceleration_m_per_s2 * t * t;
  const Eigen::Vector3d v =
      (to.velocity_m_per_s - from.velocity_m_per_s - from.acceleration_m_per_s2 * t) * t;
  const Eigen::Vector3d a = (to.acceleration_m_per_s2 - from.acceleration_m_per_s2) * t * t;
  high_ = {(10 * x - 4 * v + 0.5 * a) / std::pow(t, 3), (-15 * x + 7 * v - a) / std::pow(t, 4),
           (6 * x - 3 * v + 0.5 * a) / std::pow(t, 5)};
}

MotionState Quintic::at(double time_s) const {
  const double t = time_s - start_s_;
  if (t >= duration_s_) {
    const Eigen::Vector3d onward = (t - duration_s_) * to_.velocity_m_per_s;
    return {to_.position_m + onward, to_.velocity_m_per_s, Eigen::Vector3d::Zero()};
  }
  const auto& [c3, c4, c5] = high_;
  return {from_.position_m + t * (from_.velocity_m_per_s + t * (0.5 * from_.acceleration_m_per_s2 +
                                                                t * (c3 + t * (c4 + t * c5)))),
          from_.velocity_m_per_s +
              t * (from_.acceleration_m_per_s2 + t * (3 * c3 + t * (4 * c4 + t * 5 * c5))),
          from_.acceleration_m_per_s2 + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))};
}

double draw(RandomStream& random, const Interval& range) {
  return random.uniform(range[0], range[1]);
}

int draw_integer(RandomStream& random, const Interval& range) {
  const auto low = std::lround(range[0]), high = std::lround(range[1]);
  return static_cast<int>(
      low + static_cast<long>(random.below(static_cast<std::uint64_t>(high - low + 1))));
}

Eigen::Vector3d draw(RandomStream& random, const Box& box) {
  const double z = random.uniform(box[4], box[5]), y = random.uniform(box[2], box[3]),
               x = random.uniform(box[0], box[1]);
  return {x, y, z};
}

SmoothNoise::SmoothNoise(RandomStream& random, double bandwidth_hz) {
  for (int i = 0; i < terms; ++i) {
    const double frequency_hz = bandwidth_hz * (i + random.uniform()) / terms;
    rate_rad_per_s_[i] = 2 * std::numbers::pi * frequency_hz;
    phase_rad_[i] = random.uniform(0.0, 2 * std::numbers::pi);
  }
}

double SmoothNoise::at(double time_s) const {
  Lanes all{};
  for (int i = 0; i < terms; i += num_lanes)
    all += sin_cos(load_lanes(&rate_rad_per_s_[i]) * time_s + load_lanes(&phase_rad_[i])).sine;
  return sum(all) * std::sqrt(2.0 / terms);
}

}  // namespace touchtrace::scene
