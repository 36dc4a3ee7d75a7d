#include "pipeline/label/estimate/learn_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/body_fit.h"
#include "pipeline/label/estimate/shape_problem.h"

namespace touchtrace::label {
namespace {

constexpr int search_rounds = 3, max_shrinking_rounds = 3, max_refinements = 6;
constexpr std::size_t kept_searches = 3;  // after the first round
constexpr double max_cost_ratio = 0.995;  // of a refinement that is worth another one
/// Standard deviations of the sum of cost differences over the views, above which they tell two
/// bodies apart.
constexpr double significant_difference = 2.0;
/// Weight of box sides, which err independently, against points, which share errors within a view
/// but count as independent. Chosen on simulated foam; boxes drawn too large spoil shapes at 15.
constexpr double box_weight = 5.0;
/// Box cost over that of the best body [point_sigma_m^2] above which the boxes refute a body.
constexpr double significant_box_cost = 6.0;
constexpr double shrinking_factor = 0.7;
constexpr std::size_t points_per_view = 300;
constexpr double view_reach_radii = 2.0;
/// Residual of a half extent as large as the object's radius: bounds extents that nothing shows.
/// Small enough that box planes alone can reveal a hidden end. Large enough that a small cube does
/// not grow behind the fingers that hide it.
constexpr double compactness_m = 0.025;
/// Standard deviation of a half extent that nothing shows: evenly distributed from 0.3 to 1.5
/// radii.
constexpr double unseen_half_extent_radii = 0.35;

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

struct FittedBody {
  RoundedBody body;
  std::vector<BodyFit> fits;  ///< of the views
  double cost_m2 = 0.0;       ///< of all views and of compactness
  double box_cost_m2 = 0.0;   ///< part of the box planes
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

ShapeProblem problem_at(const LearningData& data, const FittedBody& at, double loss_width_m,
                        double compactness) {
  ShapeProblem::Poses poses;
  for (const auto& fit : at.fits) poses.push_back(fit.camera_from_body);
  return {data.views, at.body, poses, loss_width_m, compactness};
}

/// Optimises shape and poses jointly.
Guess refine(const LearningData& data, const FittedBody& start, double loss_width_m) {
  auto problem = problem_at(data, start, loss_width_m, data.compactness());
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

/// Whether the views or their boxes refute a body, given one of smaller cost. Points of one view
/// err together, so the views are the independent observations; so are the sides of boxes.
bool is_refuted(const FittedBody& body, const FittedBody& better) {
  if (body.box_cost_m2 - better.box_cost_m2 > significant_box_cost * point_sigma_m * point_sigma_m)
    return true;
  double sum_m2 = 0.0, square_m4 = 0.0;
  for (std::size_t i = 0; i < body.fits.size(); ++i) {
    const double difference_m2 = body.fits[i].cost_m2 - better.fits[i].cost_m2;
    sum_m2 += difference_m2;
    square_m4 += difference_m2 * difference_m2;
  }
  return sum_m2 > significant_difference * std::sqrt(square_m4);
}

using Bodies = std::vector<FittedBody>;

double bounding_volume(const FittedBody& at) { return at.body.half_extents_m().prod(); }

/// The bodies that the best one does not refute. What lies behind the visible side is free: the
/// front of a bar also fits a plank with a rounded edge.
Bodies plausible_of(const Bodies& bodies) {
  const auto best = std::ranges::min_element(bodies, {}, &FittedBody::cost_m2);
  Bodies plausible;
  std::ranges::copy_if(bodies, std::back_inserter(plausible),
                       [&](const FittedBody& body) { return !is_refuted(body, *best); });
  return plausible;
}

FittedBody smallest_of(const Bodies& bodies) {
  return *std::ranges::min_element(bodies, {}, bounding_volume);
}

/// Searches from all start shapes; after each round only those with the smallest costs continue.
Bodies best_of_searches(const LearningData& data, Progress& progress) {
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
  Bodies bodies;
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
void shrink(const LearningData& data, Bodies& bodies, Progress& progress) {
  for (int round = 0; round < max_shrinking_rounds; ++round) {
    const FittedBody start = smallest_of(plausible_of(bodies));
    const std::vector<Eigen::Index> axes = start.body.core == Core::box
                                               ? std::vector<Eigen::Index>{0, 1, 2}
                                               : std::vector<Eigen::Index>{0, 2};
    Bodies smaller(axes.size());
    parallel_for(axes.size(), data.num_threads, [&](std::size_t i) {
      const auto from = fit_views(data, {shrunk(start.body, axes[i]), {}});
      smaller[i] = fit_views(data, refine(data, from, fine_loss_width_m));
      progress.advance();
    });
    std::ranges::move(smaller, std::back_inserter(bodies));
    if (smallest_of(plausible_of(bodies)).cost_m2 == start.cost_m2) break;
  }
}

Eigen::Vector3d sorted_half_extents_m(const FittedBody& at) {
  Eigen::Vector3d half_m = at.body.half_extents_m();
  std::ranges::sort(half_m);
  return half_m;
}

/// The body whose half extents are nearest to the medians.
const FittedBody& typical_of(const Bodies& bodies) {
  Eigen::Vector3d middle_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> half_m;
    for (const auto& body : bodies) half_m.push_back(sorted_half_extents_m(body)[axis]);
    middle_m[axis] = median(std::move(half_m));
  }
  return *std::ranges::min_element(bodies, {}, [&](const FittedBody& body) {
    return (sorted_half_extents_m(body) - middle_m).norm();
  });
}

/// RMS difference of the half extents from those of `learnt`, over bodies and axes.
double half_extent_spread_m(const Bodies& bodies, const FittedBody& learnt) {
  double sum_m2 = 0.0;
  for (const auto& body : bodies)
    sum_m2 += (sorted_half_extents_m(body) - sorted_half_extents_m(learnt)).squaredNorm();
  return std::sqrt(sum_m2 / (3.0 * static_cast<double>(bodies.size())));
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
  const double prior_sigma_m = unseen_half_extent_radii * data.radius_m;
  const Eigen::Vector3d sigma_m =
      problem_at(data, learnt, fine_loss_width_m, point_sigma_m / prior_sigma_m)
          .half_extent_sigma_m();
  return {learnt.body,
          std::hypot(sigma_m.norm() / std::numbers::sqrt3, half_extent_spread_m(bodies, learnt))};
}

}  // namespace touchtrace::label
