#include "pipeline/label/estimate/learn_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/body_fit.h"
#include "pipeline/label/estimate/fitted_bodies.h"
#include "pipeline/label/estimate/shape_problem.h"

namespace touchtrace::label {
namespace {

constexpr int search_rounds = 3, max_shrinking_rounds = 3, max_refinements = 6;
constexpr std::size_t kept_searches = 3;  // after the first round
constexpr double max_cost_ratio = 0.995;  // of a refinement that is worth another one
/// Weight of box sides, which err independently, against points, which share errors within a view
/// but count as independent. Chosen on simulated foam; boxes drawn too large spoil shapes at 15.
constexpr double box_weight = 5.0;
constexpr double shrinking_factor = 0.7;
constexpr std::size_t points_per_view = 300;
constexpr double view_reach_radii = 2.0;
/// Residual of a half extent as large as the object's radius: bounds extents that nothing shows.
/// Small enough that box planes alone can reveal a hidden end. Large enough that a small cube does
/// not grow behind the fingers that hide it.
constexpr double compactness_m = 0.025;
/// Error of a half extent that nothing shows, which compactness makes small, in radii: RMS of what
/// is evenly distributed from 0.3 to 1.5 about 0.3.
constexpr double unseen_half_extent_radii = 0.7;

struct LearningData {
  std::vector<BodyView> views;
  double radius_m;  ///< approximate, of the whole object
  int num_threads;

  double compactness() const { return compactness_m / radius_m; }
};

struct Guess {
  RoundedBody body;
  ShapeProblem::Poses poses;  ///< of the views; empty: unknown
};

/// A fit near the guess or its turns, or a global one without a guess.
BodyFit fit_view(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d* guess) {
  return guess ? fit_body_near(view, body, *guess) : fit_body_globally(view, body);
}

double box_cost_m2(const BodyView& view, const RoundedBody& body,
                   const Eigen::Isometry3d& camera_from_body) {
  double cost_m2 = 0.0;
  for (const auto& outward : view.box.outward)
    cost_m2 += plane_loss.cost(extent_beyond_plane_m(body, camera_from_body, outward) /
                               view.box.sigma_ratio);
  return cost_m2;
}

FittedBody fit_views(const LearningData& data, const Guess& guess) {
  const auto& [body, poses] = guess;
  FittedBody fitted{body, std::vector<BodyFit>(data.views.size())};
  parallel_for(data.views.size(), data.num_threads, [&](std::size_t i) {
    fitted.fits[i] = fit_view(data.views[i], guess.body, poses.empty() ? nullptr : &poses[i]);
  });
  fitted.cost_m2 = 0.5 * (data.compactness() * body.half_extents_m()).squaredNorm();
  for (std::size_t i = 0; i < data.views.size(); ++i) {
    fitted.cost_m2 += fitted.fits[i].cost_m2;
    fitted.box_cost_m2 += box_cost_m2(data.views[i], body, fitted.fits[i].camera_from_body);
  }
  return fitted;
}

ShapeProblem::Poses poses_of(const FittedBody& at) {
  ShapeProblem::Poses poses;
  for (const auto& fit : at.fits) poses.push_back(fit.camera_from_body);
  return poses;
}

/// Optimises shape and poses jointly.
Guess refine(const LearningData& data, const FittedBody& start, double loss_width_m) {
  ShapeProblem problem(data.views, start.body, poses_of(start), loss_width_m, data.compactness());
  problem.solve();
  return {problem.body(), problem.poses()};
}

/// Start of a shape search: core half extents and edge radius in radii of the object, and the loss
/// width of the first round. A fine loss ignores far points, a coarse one grows to outliers; which
/// was right shows in the final cost.
struct StartShape {
  Core core;
  std::array<double, 3> inner;
  double edge, loss_width_m;
};
constexpr std::array<StartShape, 7> start_shapes{
    {{Core::box, {0.2, 0.4, 0.7}, 0.5, fine_loss_width_m},
     {Core::box, {0.3, 0.3, 0.3}, 0.5, fine_loss_width_m},
     {Core::box, {0.1, 0.8, 1.1}, 0.3, coarse_loss_width_m},
     {Core::box, {0.1, 0.1, 1.2}, 0.1, coarse_loss_width_m},
     {Core::cylinder, {0.4, 0.4, 0.8}, 0.3, fine_loss_width_m},
     {Core::cylinder, {0.8, 0.8, 0.2}, 0.3, fine_loss_width_m},
     {Core::cylinder, {0.1, 0.1, 1.2}, 0.1, coarse_loss_width_m}}};

/// State of one shape search.
struct Search {
  FittedBody at;
  double loss_width_m = 0.0;

  void advance(const LearningData& data, Progress& progress) {
    at = fit_views(data, refine(data, at, loss_width_m));
    loss_width_m = std::max(fine_loss_width_m, 0.5 * loss_width_m);
    progress.advance();
  }
};

Search begin_search(const StartShape& start, const LearningData& data) {
  const RoundedBody body{data.radius_m * Eigen::Vector3d(start.inner.data()),
                         data.radius_m * start.edge, start.core};
  return {fit_views(data, {body, {}}), start.loss_width_m};
}

/// Searches from all start shapes; after each round only those with the smallest costs continue.
FittedBodies best_of_searches(const LearningData& data, Progress& progress) {
  std::vector<Search> searches(start_shapes.size());
  for (int round = 0; round < search_rounds; ++round) {
    // nested parallelism: threads whose search is done help with the last one
    parallel_for(searches.size(), data.num_threads, [&](std::size_t i) {
      if (round == 0) searches[i] = begin_search(start_shapes[i], data);
      searches[i].advance(data, progress);
    });
    std::ranges::sort(searches, {}, [](const Search& search) { return search.at.cost_m2; });
    searches.resize(std::min(searches.size(), kept_searches));
  }
  FittedBodies bodies;
  for (auto& search : searches) bodies.push_back(std::move(search.at));
  return bodies;
}

/// The body with one half extent reduced, for a cylinder's x and y both.
RoundedBody shrunk(RoundedBody body, Eigen::Index axis) {
  const double inner_m =
      std::max(0.0, shrinking_factor * body.half_extents_m()[axis] - body.radius_m);
  body.inner_m[axis] = inner_m;
  if (body.core == Core::cylinder && axis < 2) body.inner_m.head<2>().setConstant(inner_m);
  return body;
}

/// Adds bodies shrunk along each axis from the smallest one until that does not change. Searches
/// end in bodies that reach behind the hand; smaller ones need other poses, so that no step leads
/// there.
void shrink(const LearningData& data, FittedBodies& bodies, Progress& progress) {
  for (int round = 0; round < max_shrinking_rounds; ++round) {
    const FittedBody start = smallest_of(plausible_of(bodies));
    const std::vector<Eigen::Index> axes = start.body.core == Core::box
                                               ? std::vector<Eigen::Index>{0, 1, 2}
                                               : std::vector<Eigen::Index>{0, 2};
    FittedBodies smaller(axes.size());
    parallel_for(axes.size(), data.num_threads, [&](std::size_t i) {
      const auto from = fit_views(data, {shrunk(start.body, axes[i]), {}});
      smaller[i] = fit_views(data, refine(data, from, fine_loss_width_m));
      progress.advance();
    });
    std::ranges::move(smaller, std::back_inserter(bodies));
    if (smallest_of(plausible_of(bodies)).cost_m2 == start.cost_m2) break;
  }
}

/// Refines until the cost stops falling.
FittedBody converge(const LearningData& data, FittedBody at, Progress& progress) {
  for (int round = 0; round < max_refinements; ++round) {
    auto next = fit_views(data, refine(data, at, fine_loss_width_m));
    progress.advance();
    if (!(next.cost_m2 < max_cost_ratio * at.cost_m2)) break;
    at = std::move(next);
  }
  return at;
}

/// A view without the points nearest to a side that faces away from the camera: noise puts points
/// of a thin body there, which would seem to show its thickness.
BodyView facing_camera(BodyView view, const RoundedBody& body,
                       const Eigen::Isometry3d& camera_from_body) {
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  const Eigen::Vector3d origin = body_from_camera * view.origin_m;
  std::erase_if(view.surface_points, [&](const Eigen::Vector3f& measured) {
    const Eigen::Vector3d point = body_from_camera * measured.cast<double>();
    return surface_distance(body, point).outward.dot(point - origin) > 0.0;
  });
  return view;
}

/// Standard deviation of the half extents, RMS over the axes, from noise and unseen sides.
double half_extent_sigma_m(const LearningData& data, const FittedBody& learnt) {
  const auto poses = poses_of(learnt);
  std::vector<BodyView> views;
  for (std::size_t i = 0; i < poses.size(); ++i)
    views.push_back(facing_camera(data.views[i], learnt.body, poses[i]));
  const double prior_sigma_m = unseen_half_extent_radii * data.radius_m;
  ShapeProblem problem(views, learnt.body, poses, fine_loss_width_m, point_sigma_m / prior_sigma_m);
  return problem.half_extent_sigma_m().norm() / std::numbers::sqrt3;
}

void weigh_boxes(LearningData& data, double weight) {
  for (auto& view : data.views) view.box.sigma_ratio /= std::sqrt(weight);
}

/// Median radius of the views' boxes; 0 without boxes.
double boxed_radius_m(const std::vector<BodyView>& views) {
  std::vector<double> radii_m;
  for (const auto& view : views)
    if (view.has_box_planes()) radii_m.push_back(view.box.radius_m);
  return radii_m.empty() ? 0.0 : median(std::move(radii_m));
}

}  // namespace

LearntBody learn_body(const std::vector<BodyView>& views, double radius_m, int num_threads) {
  LearningData data{{}, std::max(radius_m, boxed_radius_m(views)), num_threads};
  for (const auto& view : views) {
    data.views.push_back(subsample(view,
                                   initial_centre(view, {Eigen::Vector3d::Zero(), data.radius_m}),
                                   view_reach_radii * data.radius_m, points_per_view));
    data.views.back().noise_ratio = std::max(view.noise_ratio, shared_noise_ratio);
  }
  weigh_boxes(data, box_weight);
  Progress progress("learning the object's shape", start_shapes.size() +
                                                       (search_rounds - 1) * kept_searches +
                                                       3 * max_shrinking_rounds + max_refinements);
  auto bodies = best_of_searches(data, progress);
  shrink(data, bodies, progress);
  bodies = plausible_of(bodies);
  const auto learnt = converge(data, typical_of(bodies), progress);
  weigh_boxes(data, 1.0 / box_weight);  // standard deviations are those of the boxes as drawn
  return {learnt.body,
          std::hypot(half_extent_sigma_m(data, learnt), half_extent_spread_m(bodies, learnt))};
}

}  // namespace touchtrace::label
