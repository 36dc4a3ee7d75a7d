#include "calib/smooth/motion_prior.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

double square(double x) { return x * x; }

}  // namespace

template <StateModel model>
MotionPrior<model>::MotionPrior(const MotionNoise& noise, const std::vector<ContactEvent>& events,
                                double throw_duration)
    : noise_(noise) {
  // whether contact before event i lasts longer than both throwing phases around it
  const auto has_rest_before = [&](std::size_t i) {
    return i == 0 || i == events.size() ||
           events[i - 1].time + throw_duration < events[i].time - throw_duration;
  };
  const auto is_hit = [&](std::size_t i) {
    return !events[i].is_release && i + 1 < events.size() && events[i + 1].time <= events[i].time;
  };
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto& [time, is_release] = events[i];
    if (is_hit(i)) {
      changes_.push_back({time, Mode::flight, Jump::hit});
      ++i;  // its release
      continue;
    }
    if (is_release && has_rest_before(i))
      changes_.push_back({time - throw_duration, Mode::throwing, Jump::none});
    changes_.push_back({time, is_release ? Mode::flight : Mode::throwing,
                        is_release ? Jump::release : Jump::landing});
    if (!is_release && has_rest_before(i + 1))
      changes_.push_back({time + throw_duration, Mode::contact, Jump::none});
  }
}

template <StateModel model>
double MotionPrior<model>::wander_rate() const {
  return std::sqrt(3.0) / noise_.wander_time_s;
}

template <StateModel model>
typename MotionPrior<model>::Mode MotionPrior<model>::mode_at(double time) const {
  const auto next = std::ranges::upper_bound(changes_, time, {}, &ModeChange::time);
  return next == changes_.begin() ? Mode::contact : std::prev(next)->mode;
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::between(double from, double to) const {
  auto change = std::ranges::upper_bound(changes_, from, {}, &ModeChange::time);
  Mode mode = mode_at(from);
  if (change == changes_.end() || to < change->time) return during(mode, to - from);
  Step total;
  double now = from;
  for (; change != changes_.end() && change->time <= to; ++change) {
    total = total.then(during(mode, change->time - now));
    mode = change->mode, now = change->time;
    if (change->jump != Jump::none) total = total.then(jump(change->jump));
  }
  return total.then(during(mode, to - now));
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::during(Mode mode, double duration) const {
  if (mode == Mode::flight) return free_flight(duration);
  auto step = in_contact(duration);
  if (mode == Mode::throwing) step.Q *= noise_.throw_density_ratio;
  return step;
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::in_contact(double duration) const {
  const auto motion = contact_step(duration, noise_.jerk_density, noise_.bandwidth_rad_per_s);
  Step step;
  step.F.template topLeftCorner<motion_size, motion_size>() = motion.F;
  step.Q.template topLeftCorner<motion_size, motion_size>() = motion.Q;
  return step;
}

/// Free flight without gravity, which a release adds to the acceleration: jerk = -drag a, from
/// v' = g - drag v. exp(-drag h) is expanded up to (drag h)^3; the error is (drag h)^4 / 24.
template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::free_flight(double h) const {
  const double x = -noise_.flight_drag_per_s * h, third = 1.0 + x / 3.0 * (1.0 + x / 4.0),
               half = 1.0 + x / 2.0 * third;
  Step step;
  step.F(0, 1) = h, step.F(0, 2) = h * h / 2.0 * third;
  step.F(1, 2) = h * half, step.F(2, 2) = 1.0 + x * half;
  step.Q_fixed.template topLeftCorner<motion_size, motion_size>() =
      contact_step(h, noise_.flight_jerk_density, 0.0).Q;
  if constexpr (model == StateModel::with_flights) add_wander(step, h);
  return step;
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::jump(Jump kind) const {
  return kind == Jump::release ? release() : kind == Jump::landing ? landing() : hit();
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::release() const {
  Step step;
  step.F(2, 1) = -noise_.flight_drag_per_s, step.F(2, 2) = 0.0;
  step.u[2] = 1.0;
  step.Q_fixed(2, 2) = square(noise_.flight_acceleration_sigma_m_per_s2);
  if constexpr (model == StateModel::with_flights) {
    step.F.template bottomRightCorner<2, 2>().setZero();
    step.Q_fixed.template bottomRightCorner<2, 2>().diagonal().setConstant(
        square(noise_.wander_sigma_m));
  }
  return step;
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::landing() const {
  Step step;
  step.F(1, 1) = noise_.landing_velocity_fraction, step.F(2, 2) = 0.0;
  step.Q_fixed(1, 1) = square(noise_.landing_velocity_sigma_m_per_s);
  step.Q_fixed(2, 2) = square(noise_.landing_acceleration_sigma_m_per_s2);
  if constexpr (model == StateModel::with_flights) step.F(motion_size + 1, motion_size + 1) = 0.0;
  return step;
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::hit() const {
  Step velocity;
  velocity.F(1, 1) = 0.0;
  velocity.Q_fixed(1, 1) = square(noise_.flight_velocity_sigma_m_per_s);
  Step step = velocity.then(release());
  if constexpr (model == StateModel::with_flights)
    step.F(motion_size, motion_size) = 1.0, step.Q_fixed(motion_size, motion_size) = 0.0;
  return step;
}

/// A Matern process of smoothness 3/2, in the states (offset, derivative over wander_rate).
template <StateModel model>
void MotionPrior<model>::add_wander(Step& step, double duration) const {
  const double x = wander_rate() * duration;
  Eigen::Matrix2d F;
  F << 1.0 + x, x, -x, 1.0 - x;
  F *= std::exp(-x);
  step.F.template bottomRightCorner<2, 2>() = F;
  step.Q_fixed.template bottomRightCorner<2, 2>() =
      square(noise_.wander_sigma_m) * (Eigen::Matrix2d::Identity() - F * F.transpose());
}

template <StateModel model>
typename MotionPrior<model>::Step MotionPrior<model>::initial(double flat) const {
  const double b = noise_.bandwidth_rad_per_s, density = noise_.jerk_density;
  Step step;
  step.F.setZero();
  step.Q_fixed(0, 0) = square(flat);
  // the stationary variances, infinite for white jerk
  step.Q_fixed(1, 1) = std::min(square(flat), density / (4.0 * b * b * b));
  step.Q_fixed(2, 2) = std::min(square(flat), density / (4.0 * b));
  const Mode mode = mode_at(0.0);
  if (mode != Mode::contact)
    step.Q_fixed(1, 1) = square(std::min(flat, noise_.flight_velocity_sigma_m_per_s));
  if (mode == Mode::flight) step = step.then(release());
  return step;
}

template class MotionPrior<StateModel::contact>;
template class MotionPrior<StateModel::with_flights>;

}  // namespace touchtrace
