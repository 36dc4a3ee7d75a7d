#include "pipeline/label/pose_tracker.h"

#include <algorithm>
#include <cmath>

namespace touchtrace::label {
namespace {

constexpr std::size_t most_points = 500;
constexpr double tracked_radii = 1.5;  // rays farther off say nothing
constexpr double forgotten_s = 0.4, shortest_s = 1e-3, turn_rad_per_root_s = 1.5;
constexpr double doubtful = 1.2;     // times the usual cost
constexpr double better = 0.9;       // part of the followed pose's cost, to leave that for another
constexpr int most_followed = 5;     // frames, before all rotations are tried
constexpr double cost_memory = 0.9;  // a frame

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_rad / angle));
}

Eigen::Vector3d turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

double points(const BodyView& view) { return static_cast<double>(view.on_m.size()); }

}  // namespace

BodyFit PoseTracker::see(const BodyView& view, double seconds) {
  const auto some =
      thinned(view, likely_center(view, box_), tracked_radii * box_.circumradius_m(), most_points);
  auto fit = seek(some, seconds);
  const Eigen::Quaterniond now(fit.camera_from_body.linear());
  const double cost_m2 = fit.cost_m2 / points(some);
  if (rotation_ && seconds > 0.0) turn_rad_per_s_ = turn_between(*rotation_, now) / seconds;
  usual_cost_m2_ =
      rotation_ ? cost_memory * usual_cost_m2_ + (1.0 - cost_memory) * cost_m2 : cost_m2;
  rotation_ = now;
  fit.information *= points(view) / points(some);
  return fit;
}

BodyFit PoseTracker::seek(const BodyView& view, double seconds) {
  if (!rotation_ || !(seconds < forgotten_s)) return fit_body_anyhow(view, box_);
  const auto followed = follow(view, seconds);
  if (++followed_ < most_followed && !(followed.cost_m2 > doubtful * usual_cost_m2_ * points(view)))
    return followed;
  followed_ = 0;
  const auto found = fit_body_anyhow(view, box_);
  return found.cost_m2 < better * followed.cost_m2 ? found : followed;
}

BodyFit PoseTracker::follow(const BodyView& view, double seconds) const {
  const auto from = [&](const Eigen::Quaterniond& rotation) {
    Eigen::Isometry3d start(rotation);
    start.pretranslate(likely_center(view, box_));
    return fit_body(view, box_, start,
                    turn_rad_per_root_s * std::sqrt(std::max(seconds, shortest_s)));
  };
  const auto still = from(*rotation_);
  const auto turned = from(rotation_by(seconds * turn_rad_per_s_) * *rotation_);
  return still.cost_m2 < turned.cost_m2 ? still : turned;
}

}  // namespace touchtrace::label
