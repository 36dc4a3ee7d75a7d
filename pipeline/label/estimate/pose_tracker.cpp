#include "pipeline/label/estimate/pose_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_tracked_points = 500, max_hypotheses = 4;
constexpr double reach_radii = 1.5;  // rays that pass farther away are ignored
// A rotation is a random walk; after the gap nothing is known of it.
constexpr double max_gap_s = 0.4, min_interval_s = 1e-3, rotation_rad_per_root_s = 1.5;
constexpr double max_misfit_ratio = 1.2;  // of the usual misfit
constexpr int max_tracked_views = 5;      // between global searches
constexpr double misfit_memory = 0.9;     // of the exponential average over views
// Negative log-likelihoods: largest of a rotation step, and largest excess over the best
// hypothesis.
constexpr double max_step_nll = 15.0, max_excess_nll = 30.0;
constexpr double duplicate_m = 0.001;  // hypotheses with centres this close are one
// Points of a view whose errors count as independent of each other and of other views'. A wrong
// shape shifts the cost of a pose by the same amount in every view. A 30th and a 100th of the
// points give about the same labels of a foam, a cube, a soap and a pipe.
constexpr double independent_points = 25.0;

Eigen::Quaterniond rotation_of(const BodyFit& fit) {
  return Eigen::Quaterniond(fit.camera_from_body.linear());
}

Eigen::Quaterniond exponential(const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_rad / angle));
}

Eigen::Vector3d rotation_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::AngleAxisd rotation(to * from.conjugate());
  return rotation.angle() * rotation.axis();
}

double rotation_sigma_rad(double seconds) {
  return rotation_rad_per_root_s * std::sqrt(std::max(seconds, min_interval_s));
}

double rotation_nll(double angle_rad, double seconds) {
  const double sigmas = angle_rad / rotation_sigma_rad(seconds);
  return seconds < max_gap_s ? std::min(0.5 * sigmas * sigmas, max_step_nll) : 0.0;
}

double num_points(const BodyView& view) { return static_cast<double>(view.surface_points.size()); }

/// Negative log-likelihood of a view. One with a drawn box counts in full, since it alone shows
/// what the hand hides.
double view_nll(const BodyView& view, double misfit_m2) {
  const double points =
      view.has_box_planes() ? num_points(view) : std::min(independent_points, num_points(view));
  return points * misfit_m2 / (point_sigma_m * point_sigma_m);
}

}  // namespace

const BodyFit& PoseTracker::update(const BodyView& view, double seconds) {
  const auto sample = subsample(view, initial_centre(view, body_),
                                reach_radii * body_.circumradius_m(), max_tracked_points);
  const bool is_continued = !views_.empty() && seconds < max_gap_s;
  auto hypotheses = is_continued ? continuations(sample, seconds) : Hypotheses();
  if (!is_continued || ++views_since_global_ >= max_tracked_views || !fits_as_usual(hypotheses)) {
    views_since_global_ = 0;
    std::ranges::move(global_candidates(sample, seconds), std::back_inserter(hypotheses));
  }
  for (auto& hypothesis : hypotheses) {
    hypothesis.view_nll = view_nll(view, hypothesis.misfit_m2);
    hypothesis.nll += hypothesis.view_nll;
    hypothesis.fit.information *= num_points(view) / num_points(sample);
  }
  prune(hypotheses);
  const double misfit_m2 = hypotheses.front().misfit_m2;
  usual_misfit_m2_ = views_.empty()
                         ? misfit_m2
                         : misfit_memory * usual_misfit_m2_ + (1.0 - misfit_memory) * misfit_m2;
  views_.push_back(std::move(hypotheses));
  steps_s_.push_back(seconds);
  return views_.back().front().fit;
}

std::vector<BodyFit> PoseTracker::viterbi_path() const {
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

std::vector<Eigen::Vector3d> PoseTracker::ambiguity_m2(const std::vector<BodyFit>& path) const {
  const auto later = later_nlls();
  std::vector<Eigen::Vector3d> squares_m2(views_.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < views_.size(); ++i) {
    std::vector<double> nlls;
    for (std::size_t j = 0; j < views_[i].size(); ++j)
      nlls.push_back(views_[i][j].nll + later[i][j]);
    const double best = std::ranges::min(nlls);
    double sum = 0.0;
    for (std::size_t j = 0; j < views_[i].size(); ++j) {
      const double weight = std::exp(best - nlls[j]);
      sum += weight;
      squares_m2[i] += weight * (views_[i][j].fit.centre_m() - path[i].centre_m()).cwiseAbs2();
    }
    squares_m2[i] /= sum;
  }
  return squares_m2;
}

std::vector<std::vector<double>> PoseTracker::later_nlls() const {
  std::vector<std::vector<double>> later(views_.size());
  if (later.empty()) return later;
  later.back().assign(views_.back().size(), 0.0);
  for (std::size_t i = views_.size() - 1; i-- > 0;) {
    later[i].assign(views_[i].size(), std::numeric_limits<double>::infinity());
    for (std::size_t from = 0; from < views_[i].size(); ++from)
      for (std::size_t to = 0; to < views_[i + 1].size(); ++to)
        later[i][from] = std::min(
            later[i][from], later[i + 1][to] + transition_nll(i + 1, from, views_[i + 1][to]));
  }
  return later;
}

double PoseTracker::transition_nll(std::size_t to, std::size_t from,
                                   const Hypothesis& hypothesis) const {
  const Hypothesis& before = views_[to - 1][from];
  // a hypothesis continues its parent with the parent's angular velocity
  if (hypothesis.parent == from) return hypothesis.nll - before.nll;
  return step_nll(before, hypothesis, steps_s_[to]) + hypothesis.view_nll;
}

double PoseTracker::step_nll(const Hypothesis& from, const Hypothesis& to, double seconds) const {
  return rotation_nll(
      symmetric_rotation_distance(body_.core, rotation_of(from.fit), rotation_of(to.fit)), seconds);
}

bool PoseTracker::fits_as_usual(const Hypotheses& hypotheses) const {
  return std::ranges::any_of(hypotheses, [&](const Hypothesis& hypothesis) {
    return hypothesis.misfit_m2 <= max_misfit_ratio * usual_misfit_m2_;
  });
}

PoseTracker::Hypotheses PoseTracker::continuations(const BodyView& view, double seconds) const {
  Hypotheses result;
  for (std::size_t parent = 0; parent < views_.back().size(); ++parent)
    for (const bool rotating : {false, true})
      result.push_back(continuation(view, parent, rotating, seconds));
  return result;
}

PoseTracker::Hypothesis PoseTracker::continuation(const BodyView& view, std::size_t parent,
                                                  bool rotating, double seconds) const {
  const Hypothesis& before = views_.back()[parent];
  const Eigen::Quaterniond rotation = rotation_of(before.fit);
  const Eigen::Vector3d initial = initial_centre(view, body_),
                        moved = before.fit.centre_m() + initial - before.initial_centre_m;
  Eigen::Isometry3d expected(rotation);
  if (rotating) expected = exponential(seconds * before.angular_velocity_rad_per_s) * rotation;
  expected.pretranslate(rotating ? initial : moved);
  const auto fit = rotating ? fit_body(view, body_, expected, rotation_sigma_rad(seconds))
                            : refit_body(view, body_, expected, rotation_sigma_rad(seconds));
  const double angle_rad = symmetric_rotation_distance(
      body_.core, Eigen::Quaterniond(expected.linear()), rotation_of(fit));
  return {.fit = fit,
          .misfit_m2 = fit.cost_m2 / num_points(view),
          .initial_centre_m = initial,
          .angular_velocity_rad_per_s =
              rotation_between(rotation, rotation_of(fit)) / std::max(seconds, min_interval_s),
          .nll = before.nll + rotation_nll(angle_rad, seconds),
          .parent = parent};
}

PoseTracker::Hypotheses PoseTracker::global_candidates(const BodyView& view, double seconds) const {
  Hypotheses result;
  for (const auto& fit : global_pose_candidates(view, body_)) {
    result.push_back({.fit = fit,
                      .misfit_m2 = fit.cost_m2 / num_points(view),
                      .initial_centre_m = initial_centre(view, body_)});
    if (!views_.empty()) link_to_best_parent(result.back(), seconds);
  }
  return result;
}

void PoseTracker::link_to_best_parent(Hypothesis& hypothesis, double seconds) const {
  hypothesis.nll = std::numeric_limits<double>::infinity();
  for (std::size_t parent = 0; parent < views_.back().size(); ++parent) {
    const Hypothesis& before = views_.back()[parent];
    const double nll = before.nll + step_nll(before, hypothesis, seconds);
    if (nll < hypothesis.nll) hypothesis.nll = nll, hypothesis.parent = parent;
  }
}

void PoseTracker::prune(Hypotheses& all) {
  std::ranges::sort(all, {}, &Hypothesis::nll);
  Hypotheses kept;
  for (const auto& one : all) {
    const auto is_duplicate = [&](const Hypothesis& other) {
      return (one.fit.centre_m() - other.fit.centre_m()).norm() < duplicate_m;
    };
    if (kept.size() == max_hypotheses || one.nll > all.front().nll + max_excess_nll) break;
    if (std::ranges::none_of(kept, is_duplicate)) kept.push_back(one);
  }
  all = std::move(kept);
}

}  // namespace touchtrace::label
