#include "pipeline/label/pose_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t most_points = 500, most_hypotheses = 4;
constexpr double tracked_radii = 1.5;  // rays farther off say nothing
constexpr double forgotten_s = 0.4, shortest_s = 1e-3, turn_rad_per_root_s = 1.5;
constexpr double doubtful = 1.2;       // times the usual misfit
constexpr int most_followed = 5;       // views, before all rotations are tried
constexpr double misfit_memory = 0.9;  // a view
// Minus logarithms of probabilities: of a turn that cannot be followed, and of what may be dropped.
constexpr double jump_surprise = 15.0, hopeless_surprise = 30.0;
constexpr double same_place_m = 0.001;  // two that agree so well are one

Eigen::Quaterniond rotation_of(const BodyFit& fit) {
  return Eigen::Quaterniond(fit.camera_from_body.linear());
}

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_rad / angle));
}

Eigen::Vector3d turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

double turn_sigma_rad(double seconds) {
  return turn_rad_per_root_s * std::sqrt(std::max(seconds, shortest_s));
}

double turn_surprise(double angle_rad, double seconds) {
  const double off = angle_rad / turn_sigma_rad(seconds);
  return seconds < forgotten_s ? std::min(0.5 * off * off, jump_surprise) : 0.0;
}

double points(const BodyView& view) { return static_cast<double>(view.on_m.size()); }

}  // namespace

const BodyFit& PoseTracker::see(const BodyView& view, double seconds) {
  const auto some = thinned(view, likely_center(view, body_),
                            tracked_radii * body_.circumradius_m(), most_points);
  const bool soon = !views_.empty() && seconds < forgotten_s;
  auto now = soon ? followed(some, seconds) : Hypotheses();
  if (!soon || ++followed_ >= most_followed || !fits_as_usual(now)) {
    followed_ = 0;
    std::ranges::move(found(some, seconds), std::back_inserter(now));
  }
  for (auto& hypothesis : now) {
    hypothesis.surprise += points(view) * hypothesis.misfit_m2 / (point_sigma_m * point_sigma_m);
    hypothesis.fit.information *= points(view) / points(some);
  }
  keep_likeliest(now);
  const double misfit_m2 = now.front().misfit_m2;
  usual_misfit_m2_ = views_.empty()
                         ? misfit_m2
                         : misfit_memory * usual_misfit_m2_ + (1.0 - misfit_memory) * misfit_m2;
  views_.push_back(std::move(now));
  return views_.back().front().fit;
}

std::vector<BodyFit> PoseTracker::likeliest() const {
  std::vector<BodyFit> path(views_.size());
  std::vector<double> misfits_m2(views_.size());
  std::size_t at = 0;
  for (std::size_t i = views_.size(); i-- > 0; at = views_[i][at].parent)
    path[i] = views_[i][at].fit, misfits_m2[i] = views_[i][at].misfit_m2;
  if (path.empty()) return path;
  const double usual_m2 = median(misfits_m2);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i].information *= std::min(1.0, usual_m2 / misfits_m2[i]);
  return path;
}

bool PoseTracker::fits_as_usual(const Hypotheses& followed) const {
  return std::ranges::any_of(followed, [&](const Hypothesis& hypothesis) {
    return hypothesis.misfit_m2 <= doubtful * usual_misfit_m2_;
  });
}

PoseTracker::Hypotheses PoseTracker::followed(const BodyView& view, double seconds) const {
  Hypotheses now;
  for (std::size_t parent = 0; parent < views_.back().size(); ++parent)
    for (const bool turning : {false, true}) now.push_back(follow(view, parent, turning, seconds));
  return now;
}

PoseTracker::Hypothesis PoseTracker::follow(const BodyView& view, std::size_t parent, bool turning,
                                            double seconds) const {
  const Hypothesis& before = views_.back()[parent];
  const Eigen::Quaterniond rotation = rotation_of(before.fit);
  const Eigen::Vector3d likely = likely_center(view, body_),
                        moved = before.fit.center_m() + likely - before.likely_m;
  Eigen::Isometry3d expected(rotation);
  if (turning) expected = rotation_by(seconds * before.turn_rad_per_s) * rotation;
  expected.pretranslate(turning ? likely : moved);
  const auto fit = turning ? fit_body(view, body_, expected, turn_sigma_rad(seconds))
                           : refit_body(view, body_, expected, turn_sigma_rad(seconds));
  const double off =
      turn_to_see_rad(body_.core, Eigen::Quaterniond(expected.linear()), rotation_of(fit));
  return {fit,
          fit.cost_m2 / points(view),
          likely,
          turn_between(rotation, rotation_of(fit)) / std::max(seconds, shortest_s),
          before.surprise + turn_surprise(off, seconds),
          parent};
}

/// Each from where it most likely comes from.
PoseTracker::Hypotheses PoseTracker::found(const BodyView& view, double seconds) const {
  Hypotheses now;
  for (const auto& fit : fits_anyhow(view, body_)) {
    now.push_back({fit, fit.cost_m2 / points(view), likely_center(view, body_),
                   Eigen::Vector3d::Zero(), 0.0, 0});
    if (!views_.empty()) come_from_likeliest(now.back(), seconds);
  }
  return now;
}

void PoseTracker::come_from_likeliest(Hypothesis& now, double seconds) const {
  now.surprise = std::numeric_limits<double>::infinity();
  for (std::size_t parent = 0; parent < views_.back().size(); ++parent) {
    const Hypothesis& before = views_.back()[parent];
    const double off = turn_to_see_rad(body_.core, rotation_of(before.fit), rotation_of(now.fit));
    const double surprise = before.surprise + turn_surprise(off, seconds);
    if (surprise < now.surprise) now.surprise = surprise, now.parent = parent;
  }
}

/// Of those that agree only the likeliest.
void PoseTracker::keep_likeliest(Hypotheses& all) {
  std::ranges::sort(all, {}, &Hypothesis::surprise);
  Hypotheses kept;
  for (const auto& one : all) {
    const auto agrees = [&](const Hypothesis& other) {
      return (one.fit.center_m() - other.fit.center_m()).norm() < same_place_m;
    };
    if (kept.size() == most_hypotheses || one.surprise > all.front().surprise + hopeless_surprise)
      break;
    if (std::ranges::none_of(kept, agrees)) kept.push_back(one);
  }
  all = std::move(kept);
}

}  // namespace touchtrace::label
