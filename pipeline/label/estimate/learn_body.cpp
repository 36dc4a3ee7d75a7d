#include "pipeline/label/estimate/learn_body.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/body_fit.h"
#include "pipeline/label/estimate/shape_problem.h"

namespace touchtrace::label {
namespace {

constexpr int search_rounds = 3, max_refinements = 6;
constexpr std::size_t kept_searches = 3;  // after the first round
constexpr double max_cost_ratio = 0.995;  // of a refinement that is worth another one
/// Standard deviations of the sum of cost differences over the views, above which they tell two
/// bodies apart.
constexpr double significant_difference = 2.0;
constexpr std::size_t points_per_view = 300;
constexpr double view_reach_radii = 2.0;
/// Residual of a half extent as large as the object's radius: bounds extents that nothing shows.
/// Small enough that box planes alone can reveal a hidden end. Large enough that a small cube does
/// not grow behind the fingers that hide it.
constexpr double compactness_m = 0.025;

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
};

/// The better of a global fit and one near the guess.
BodyFit fit_view(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d* guess) {
  const auto global = fit_body_globally(view, body);
  if (!guess) return global;
  const auto near = refit_body(view, body, *guess, unknown_rotation_sigma_rad);
  return near.cost_m2 < global.cost_m2 ? near : global;
}

FittedBody fit_views(const LearningData& data, const Guess& guess) {
  const auto& [body, poses] = guess;
  FittedBody fitted{body, std::vector<BodyFit>(data.views.size())};
  parallel_for(data.views.size(), data.num_threads, [&](std::size_t i) {
    fitted.fits[i] = fit_view(data.views[i], guess.body, poses.empty() ? nullptr : &poses[i]);
  });
  fitted.cost_m2 = 0.5 * (data.compactness() * body.half_extents_m()).squaredNorm();
  for (const auto& fit : fitted.fits) fitted.cost_m2 += fit.cost_m2;
  return fitted;
}

ShapeProblem problem_at(const LearningData& data, const FittedBody& at, double loss_width_m) {
  ShapeProblem::Poses poses;
  for (const auto& fit : at.fits) poses.push_back(fit.camera_from_body);
  return {data.views, at.body, poses, loss_width_m, data.compactness()};
}

/// Optimises shape and poses jointly.
Guess refine(const LearningData& data, const FittedBody& start, double loss_width_m) {
  auto problem = problem_at(data, start, loss_width_m);
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

/// Whether the views refute a body, given a better one. Points of one view err together, so the
/// views are the independent observations.
bool is_refuted(const FittedBody& body, const FittedBody& better) {
  double sum_m2 = 0.0, square_m4 = 0.0;
  for (std::size_t i = 0; i < body.fits.size(); ++i) {
    const double difference_m2 = body.fits[i].cost_m2 - better.fits[i].cost_m2;
    sum_m2 += difference_m2;
    square_m4 += difference_m2 * difference_m2;
  }
  return sum_m2 > significant_difference * std::sqrt(square_m4);
}

/// The smallest of the bodies that the views do not refute. `bodies`: by cost. What lies behind the
/// visible side is free: the front of a bar also fits a plank with a rounded edge.
FittedBody smallest_of(std::vector<Search> bodies) {
  const FittedBody best = bodies.front().at;
  std::erase_if(bodies, [&](const Search& search) { return is_refuted(search.at, best); });
  return std::ranges::min(
             bodies, {},
             [](const Search& search) { return search.at.body.half_extents_m().prod(); })
      .at;
}

/// Searches from all start shapes; after each round only those with the smallest costs continue.
FittedBody best_of_searches(const LearningData& data, Progress& progress) {
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
  return smallest_of(std::move(searches));
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
  for (const auto& view : views)
    data.views.push_back(subsample(view,
                                   initial_centre(view, {Eigen::Vector3d::Zero(), data.radius_m}),
                                   view_reach_radii * data.radius_m, points_per_view));
  Progress progress("learning the object's shape",
                    start_shapes.size() + (search_rounds - 1) * kept_searches + max_refinements);
  const auto best = converge(data, best_of_searches(data, progress), progress);
  return {best.body, problem_at(data, best, fine_loss_width_m).half_extent_sigma_m()};
}

}  // namespace touchtrace::label
