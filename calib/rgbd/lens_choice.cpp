#include "calib/rgbd/lens_choice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr double most_effect = 1.0;  ///< of the distance from the centre

std::vector<std::string> lens_names() {
  std::vector<std::string> names;
  for (const Lens& lens : all_lenses()) names.push_back(lens_name(lens));
  return names;
}

/// All intrinsics of a lens.
std::vector<int> everything(const Lens& lens) {
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(intrinsic_names(lens).size()); ++i) all.push_back(i);
  return all;
}

/// In the plane of the ideal lens, from the centre.
Eigen::Vector2d outermost(const BoardProblem& problem, const RgbdParameters& p) {
  Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
  for (std::size_t view = 0; view < problem.used.size(); ++view) {
    if (!problem.used[view]) continue;
    const Eigen::Isometry3d pose = pose_of(p.camera_from_board[view]);
    const BoardView& seen = problem.observations.views[view];
    for (std::size_t i = 0; i < seen.corners_px.size(); ++i) {
      const Eigen::Vector3d point = pose * problem.observations.board.corner_m(seen.corner(i));
      const Eigen::Vector2d m =
          with_lens(p.lens, [&](auto l) -> Eigen::Vector2d { return l.spread(point); });
      if (m.norm() > farthest.norm()) farthest = m;
    }
  }
  return farthest;
}

/// How far coefficient `i`, changed by `step`, moves `m`, over m's distance from the centre.
double effect(const RgbdParameters& p, std::size_t i, double step, const Eigen::Vector2d& m) {
  auto changed = p.color;
  changed[4 + i] += step;
  return with_lens(p.lens, [&](auto l) {
    return (l.bend(changed.data() + 4, m) - l.bend(p.color.data() + 4, m)).norm() / m.norm();
  });
}

}  // namespace

LensChoice lens_choice(const std::string& name) {
  const auto lens = lens_of(name);
  if (!lens)
    throw usage_error(fmt::format("there is no lens '{}'", name), suggestion(name, lens_names()));
  if (!std::holds_alternative<Undistorted>(*lens)) return {*lens, *lens, everything(*lens)};
  return {*lens, Radtan4{}, {0, 1, 2, 3, 6, 7}};
}

std::vector<LensChoice> lens_choices(const std::vector<std::string>& names) {
  std::vector<LensChoice> choices;
  for (const std::string& name : names.empty() ? lens_names() : names)
    choices.push_back(lens_choice(name));
  return choices;
}

std::optional<Untold> untold_coefficient(const BoardProblem& problem, const RgbdParameters& p) {
  const Eigen::MatrixXd c = covariance(problem, p);
  const Eigen::Vector2d m = outermost(problem, p);
  const auto names = coefficient_names(p.lens);
  std::optional<Untold> last;
  std::string open;
  for (std::size_t at = 0; at < problem.free_color.size(); ++at) {
    const int index = problem.free_color[at];
    if (index < 4 || std::isfinite(problem.prior.color_sigma[static_cast<std::size_t>(index)]))
      continue;
    const auto coefficient = static_cast<std::size_t>(index - 4);
    last = {index, names[coefficient], {}};
    if (c.size() == 0) {
      open = "the equations for it are singular";
      continue;
    }
    const double sigma = std::sqrt(c(Eigen::Index(at), Eigen::Index(at)));
    if (!(effect(p, coefficient, sigma, m) <= most_effect) ||
        !(effect(p, coefficient, -sigma, m) <= most_effect))
      open += fmt::format("{}{} is known to +-{:.3g} only", open.empty() ? "" : ", ",
                          names[coefficient], sigma);
  }
  if (!last || open.empty()) return {};
  last->why = open;
  return last;
}

}  // namespace touchtrace
