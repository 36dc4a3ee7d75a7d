#include "pipeline/label/learn_body.h"

#include <algorithm>
#include <array>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/label/body_fit.h"
#include "pipeline/label/shape_problem.h"

namespace touchtrace::label {
namespace {

constexpr int rounds = 3, more_rounds = 6;
constexpr std::size_t kept_searches = 3;  // after the first round
constexpr double helped = 0.995;          // part of the cost that a round which helped leaves
constexpr std::size_t view_points = 300;
constexpr double passing_radii = 2.0;
/// A half extent of as much as the object's radius costs as much as a point so far off: holds what
/// nothing shows. What boxes show alone, an object's hidden end, has to be worth more; and that
/// fingers, which hide much of a small cube, leave room for more of it, less.
constexpr double compactness_m = 0.025;

/// What a shape is learnt from.
struct Evidence {
  std::vector<BodyView> views;
  double radius_m;  ///< of all of the object, about
  int threads;

  double compactness() const { return compactness_m / radius_m; }
};

/// A shape, and the views' poses if something is known of them.
struct Guess {
  RoundedBody body;
  ShapeProblem::Poses poses;
};

/// A shape and how all views fit it; its compactness is part of the cost.
struct Learnt {
  RoundedBody body;
  std::vector<BodyFit> fits;
  double cost_m2 = 0.0;
};

/// Where rotations all around lead, or where the guess does.
BodyFit fit_view(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d* guess) {
  const auto anyhow = fit_body_anyhow(view, body);
  if (!guess) return anyhow;
  const auto near = refit_body(view, body, *guess, unknown_rad);
  return near.cost_m2 < anyhow.cost_m2 ? near : anyhow;
}

Learnt fitted(const Evidence& evidence, const Guess& guess) {
  const auto& [body, poses] = guess;
  Learnt learnt{body, std::vector<BodyFit>(evidence.views.size())};
  parallel_for(evidence.views.size(), evidence.threads, [&](std::size_t i) {
    learnt.fits[i] = fit_view(evidence.views[i], guess.body, poses.empty() ? nullptr : &poses[i]);
  });
  learnt.cost_m2 = 0.5 * (evidence.compactness() * body.half_extents_m()).squaredNorm();
  for (const auto& fit : learnt.fits) learnt.cost_m2 += fit.cost_m2;
  return learnt;
}

ShapeProblem problem_at(const Evidence& evidence, const Learnt& at, double width_m) {
  ShapeProblem::Poses poses;
  for (const auto& fit : at.fits) poses.push_back(fit.camera_from_body);
  return {evidence.views, at.body, poses, width_m, evidence.compactness()};
}

/// Shape and poses together, from poses that are right but for the shape.
Guess refine(const Evidence& evidence, const Learnt& start, double width_m) {
  auto problem = problem_at(evidence, start, width_m);
  problem.solve();
  return {problem.body(), problem.poses()};
}

/// Where a search for a shape begins: half extents and radius in radii of the object, and the width
/// of the first round's loss. A narrow one does not see what is far from where it begins, a wide
/// one grows to strays: which was right only the end tells.
struct Start {
  Core core;
  std::array<double, 3> inner;
  double edge, width_m;
};
constexpr std::array<Start, 7> starts{{{Core::box, {0.2, 0.4, 0.7}, 0.5, fine_width_m},
                                       {Core::box, {0.3, 0.3, 0.3}, 0.5, fine_width_m},
                                       {Core::box, {0.1, 0.8, 1.1}, 0.3, rough_width_m},
                                       {Core::box, {0.1, 0.1, 1.2}, 0.1, rough_width_m},
                                       {Core::cylinder, {0.4, 0.4, 0.8}, 0.3, fine_width_m},
                                       {Core::cylinder, {0.8, 0.8, 0.2}, 0.3, fine_width_m},
                                       {Core::cylinder, {0.1, 0.1, 1.2}, 0.1, rough_width_m}}};

/// A search for a shape, and how far it came.
struct Search {
  Learnt at;
  double width_m = 0.0;

  void go_on(const Evidence& evidence, Progress& progress) {
    at = fitted(evidence, refine(evidence, at, width_m));
    width_m = std::max(fine_width_m, 0.5 * width_m);
    progress.advance();
  }
};

Search begin(const Start& start, const Evidence& evidence) {
  const RoundedBody first{evidence.radius_m * Eigen::Vector3d(start.inner.data()),
                          evidence.radius_m * start.edge, start.core};
  return {fitted(evidence, {first, {}}), start.width_m};
}

/// The best of all that begin somewhere; those that soon fit worse than others are given up.
Learnt best_of_searches(const Evidence& evidence, Progress& progress) {
  std::vector<Search> searches(starts.size());
  for (int round = 0; round < rounds; ++round) {
    // each on all threads: those of searches that are done help with the last
    parallel_for(searches.size(), evidence.threads, [&](std::size_t i) {
      if (round == 0) searches[i] = begin(starts[i], evidence);
      searches[i].go_on(evidence, progress);
    });
    std::ranges::sort(searches, {}, [](const Search& search) { return search.at.cost_m2; });
    searches.resize(std::min(searches.size(), kept_searches));
  }
  return std::move(searches.front().at);
}

/// More rounds, as long as they help.
Learnt settled(const Evidence& evidence, Learnt at, Progress& progress) {
  for (int round = 0; round < more_rounds; ++round) {
    auto next = fitted(evidence, refine(evidence, at, fine_width_m));
    progress.advance();
    if (!(next.cost_m2 < helped * at.cost_m2)) break;
    at = std::move(next);
  }
  return at;
}

/// Of what boxes hold; 0 if there are none.
double marked_radius_m(const std::vector<BodyView>& views) {
  std::vector<double> radii_m;
  for (const auto& view : views)
    if (view.is_marked()) radii_m.push_back(view.marked.radius_m);
  return radii_m.empty() ? 0.0 : median(std::move(radii_m));
}

}  // namespace

LearntBody learn_body(const std::vector<BodyView>& views, double radius_m, int threads) {
  Evidence evidence{{}, std::max(radius_m, marked_radius_m(views)), threads};
  for (const auto& view : views)
    evidence.views.push_back(
        thinned(view, likely_center(view, {Eigen::Vector3d::Zero(), evidence.radius_m}),
                passing_radii * evidence.radius_m, view_points));
  Progress progress("learning the object's shape",
                    starts.size() + (rounds - 1) * kept_searches + more_rounds);
  const auto best = settled(evidence, best_of_searches(evidence, progress), progress);
  return {best.body, problem_at(evidence, best, fine_width_m).half_extent_sigma_m()};
}

}  // namespace touchtrace::label
