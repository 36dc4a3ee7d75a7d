#include "calib/rig/epipolar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/rotation.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_folds = 10;
constexpr double derivative_step_px = 0.5;

/// Two cameras of a rig; pixels of `b` and `a` of one point satisfy ray_b' essential ray_a = 0.
struct EpipolarGeometry {
  Camera a, b;
  Eigen::Matrix3d essential;

  double constraint(const Eigen::Vector2d& in_a, const Eigen::Vector2d& in_b) const {
    return b.unproject(in_b).dot(essential * a.unproject(in_a));
  }
};

/// Squared distances [px^2] of a corner to its epipolar curve, summed over both images.
double squared_distances(const EpipolarGeometry& g, const Eigen::Vector2d& in_a,
                         const Eigen::Vector2d& in_b) {
  Eigen::Vector2d by_a, by_b;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = derivative_step_px * Eigen::Vector2d::Unit(i);
    by_a[i] = g.constraint(in_a + step, in_b) - g.constraint(in_a - step, in_b);
    by_b[i] = g.constraint(in_a, in_b + step) - g.constraint(in_a, in_b - step);
  }
  const double error = g.constraint(in_a, in_b) * 2.0 * derivative_step_px;
  return error * error * (1.0 / by_a.squaredNorm() + 1.0 / by_b.squaredNorm());
}

Camera camera_of(const RigProblem& problem, const RigParameters& p, std::size_t camera) {
  return color_camera(problem.observations[camera], single_camera(problem, p, camera));
}

EpipolarGeometry geometry(const RigProblem& problem, const RigParameters& p, std::size_t a,
                          std::size_t b) {
  const Eigen::Isometry3d b_from_a =
      pose_of(p.cameras[b].camera_from_rig) * pose_of(p.cameras[a].camera_from_rig).inverse();
  return {camera_of(problem, p, a), camera_of(problem, p, b),
          cross_matrix(b_from_a.translation()) * b_from_a.linear()};
}

/// Sum of squared distances, and their number.
struct Sum {
  double squares = 0.0;
  std::size_t count = 0, num_frames = 0;
};

using Pair = std::pair<std::size_t, std::size_t>;

void add_views(const BoardView& a, const BoardView& b, const EpipolarGeometry& g, Sum& sum) {
  std::map<int, Eigen::Vector2d> in_a;
  for (std::size_t i = 0; i < a.corners_px.size(); ++i) in_a[a.corner_id(i)] = a.corners_px[i];
  for (std::size_t i = 0; i < b.corners_px.size(); ++i) {
    const auto same = in_a.find(b.corner_id(i));
    if (same == in_a.end()) continue;
    sum.squares += squared_distances(g, same->second, b.corners_px[i]);
    sum.count += 2;
  }
}

void add_frames(const RigProblem& problem, const RigParameters& p,
                const std::vector<std::size_t>& frames, std::map<Pair, Sum>& sums) {
  for (std::size_t a = 0; a < p.cameras.size(); ++a)
    for (std::size_t b = a + 1; b < p.cameras.size(); ++b) {
      const EpipolarGeometry g = geometry(problem, p, a, b);
      for (std::size_t frame : frames) {
        const auto &view_a = problem.frames[frame].views[a],
                   &view_b = problem.frames[frame].views[b];
        if (!view_a || !view_b) continue;
        add_views(problem.observations[a].views[*view_a], problem.observations[b].views[*view_b], g,
                  sums[{a, b}]);
        ++sums[{a, b}].num_frames;
      }
    }
}

}  // namespace

std::vector<EpipolarError> held_out_epipolar_errors(const RigProblem& problem,
                                                    const RigParameters& solution) {
  std::vector<std::size_t> shared;
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (problem.used[frame] && problem.frames[frame].num_views() > 1) shared.push_back(frame);
  const std::size_t folds = std::min(max_folds, shared.size());
  std::map<Pair, Sum> sums;
  bool converged = true;
  for (std::size_t first = 0; first < folds; ++first) {
    throw_if_interrupted();
    RigProblem rest = problem;
    RigParameters p = solution;
    std::vector<std::size_t> fold;
    for (std::size_t i = first; i < shared.size(); i += folds) {
      fold.push_back(shared[i]);
      rest.used[shared[i]] = false;
    }
    converged = solve(rest, p) && converged;
    add_frames(problem, p, fold, sums);
  }
  std::vector<EpipolarError> errors;
  for (const auto& [pair, sum] : sums)
    errors.push_back({pair.first, pair.second, sum.num_frames,
                      converged ? std::sqrt(sum.squares / static_cast<double>(sum.count))
                                : std::numeric_limits<double>::quiet_NaN()});
  return errors;
}

}  // namespace touchtrace
