#include "calib/rgbd/lens_choice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr double max_effect = 1.0;  ///< of one sigma, as returned by effect()

std::vector<std::string> lens_names() {
  std::vector<std::string> names;
  for (const Lens& lens : all_lenses()) names.push_back(lens_name(lens));
  return names;
}

std::vector<int> all_intrinsics(const Lens& lens) {
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(intrinsic_names(lens).size()); ++i) all.push_back(i);
  return all;
}

/// Undistorted coordinates of the corner that is farthest from the optical axis.
Eigen::Vector2d outermost_corner(const BoardProblem& problem, const RgbdParameters& p) {
  Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
  for (std::size_t view = 0; view < problem.used.size(); ++view) {
    if (!problem.used[view]) continue;
    const Eigen::Isometry3d pose = pose_of(p.camera_from_board[view]);
    const BoardView& seen = problem.observations.views[view];
    for (std::size_t i = 0; i < seen.corners_px.size(); ++i) {
      const Eigen::Vector3d point =
          pose * deformed_corner_m(problem.observations.board, seen.corner_id(i), p);
      const Eigen::Vector2d m =
          with_lens(p.lens, [&](auto l) -> Eigen::Vector2d { return l.normalize(point); });
      if (m.norm() > farthest.norm()) farthest = m;
    }
  }
  return farthest;
}

/// Displacement of `m` when coefficient `i` changes by `step`, relative to |m|.
double effect(const RgbdParameters& p, std::size_t i, double step, const Eigen::Vector2d& m) {
  auto changed = p.color;
  changed[4 + i] += step;
  return with_lens(p.lens, [&](auto l) {
    return (l.distort(changed.data() + 4, m) - l.distort(p.color.data() + 4, m)).norm() / m.norm();
  });
}

bool has_prior(const Prior& prior, int index) {
  return index < 4 || std::isfinite(prior.color_sigma[static_cast<std::size_t>(index)]);
}

/// Index in `free` of the last coefficient without a prior.
std::optional<std::size_t> last_without_prior(const Prior& prior, const std::vector<int>& free) {
  for (std::size_t at = free.size(); at-- > 0;)
    if (!has_prior(prior, free[at])) return at;
  return {};
}

/// Describes the unobservable ones of the `free` coefficients with covariance `c`; empty if there
/// are none.
std::string describe_unobservable(const Prior& prior, const RgbdParameters& p,
                                  const std::vector<int>& free, const Eigen::MatrixXd& c,
                                  const Eigen::Vector2d& m) {
  if (c.size() == 0) return "the normal equations are singular";
  const auto names = coefficient_names(p.lens);
  std::string text;
  for (std::size_t at = 0; at < free.size(); ++at) {
    if (has_prior(prior, free[at])) continue;
    const auto coefficient = static_cast<std::size_t>(free[at] - 4);
    const double sigma = std::sqrt(c(Eigen::Index(at), Eigen::Index(at)));
    if (!(effect(p, coefficient, sigma, m) <= max_effect) ||
        !(effect(p, coefficient, -sigma, m) <= max_effect))
      text += fmt::format("{}standard deviation of {} is {:.3g}", text.empty() ? "" : ", ",
                          names[coefficient], sigma);
  }
  return text;
}

/// Information matrix with the parameter `at` fixed.
Eigen::MatrixXd fix_parameter(const Eigen::MatrixXd& information, Eigen::Index at) {
  if (information.size() == 0) return information;
  std::vector<Eigen::Index> rest;
  for (Eigen::Index i = 0; i < information.rows(); ++i)
    if (i != at) rest.push_back(i);
  return information(rest, rest);
}

}  // namespace

LensChoice lens_choice(const std::string& name) {
  const auto lens = find_lens(name);
  if (!lens)
    throw usage_error(fmt::format("unknown lens '{}'", name), suggestion(name, lens_names()));
  if (!std::holds_alternative<Undistorted>(*lens)) return {*lens, *lens, all_intrinsics(*lens)};
  return {*lens, Radtan4{}, {0, 1, 2, 3, 6, 7}};
}

std::vector<LensChoice> lens_choices(const std::vector<std::string>& names) {
  std::vector<LensChoice> choices;
  for (const std::string& name : names.empty() ? lens_names() : names)
    choices.push_back(lens_choice(name));
  return choices;
}

std::vector<UnobservableCoefficient> find_unobservable_coefficients(const BoardProblem& problem,
                                                                    const RgbdParameters& p) {
  if (!last_without_prior(problem.prior, problem.free_color)) return {};
  Eigen::MatrixXd all = information(problem, p);
  const Eigen::Vector2d m = outermost_corner(problem, p);
  std::vector<UnobservableCoefficient> removed;
  std::vector<int> free = problem.free_color;
  while (const auto last = last_without_prior(problem.prior, free)) {
    const auto c = marginal_covariance(all, static_cast<Eigen::Index>(free.size()));
    const std::string why = describe_unobservable(problem.prior, p, free, c, m);
    if (why.empty()) break;
    const int index = free[*last];
    removed.push_back({index, coefficient_names(p.lens)[static_cast<std::size_t>(index - 4)], why});
    free.erase(free.begin() + static_cast<std::ptrdiff_t>(*last));
    all = fix_parameter(all, static_cast<Eigen::Index>(*last));
  }
  return removed;
}

}  // namespace touchtrace
