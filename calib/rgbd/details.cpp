#include "calib/rgbd/details.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/verdict.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr double max_sigma_ratio = 0.7;  ///< posterior over prior sigma of identifiable parameters

json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

json points(const std::vector<Eigen::Vector2d>& values) {
  json list = json::array();
  for (const auto& value : values) list.push_back({value.x(), value.y()});
  return list;
}

void add_depth_residuals(const DetailsInput& r, std::size_t view, json& entry) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (const auto& sample : r.problem.samples) {
    if (sample.view != view) continue;
    const double residual = depth_residual(sample, r.parameters);
    sum += residual, squares += residual * residual, count += 1.0;
  }
  if (count == 0.0) return;
  entry["depth_rms_m"] = std::sqrt(squares / count);
  entry["depth_bias_m"] = sum / count;
}

json view_details(const DetailsInput& r) {
  json list = json::array();
  const auto& observations = r.problem.observations;
  for (std::size_t view = 0; view < observations.views.size(); ++view) {
    const auto residuals = corner_residuals(observations, view, r.parameters);
    json entry{
        {"name", observations.views[view].name},
        {"used", bool(r.problem.used[view])},
        {"rms_px", rms(residuals)},
        {"corners_px", points(observations.views[view].corners_px)},
        {"residuals_px", points(residuals)},
        {"relative_edge_width", number_or_null(observations.views[view].relative_edge_width)}};
    if (!observations.views[view].corner_ids.empty())
      entry["corner_ids"] = observations.views[view].corner_ids;
    add_depth_residuals(r, view, entry);
    list.push_back(std::move(entry));
  }
  return list;
}

double coverage_of_used_views(const DetailsInput& r) {
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t view = 0; view < r.problem.used.size(); ++view)
    if (r.problem.used[view])
      std::ranges::copy(r.problem.observations.views[view].corners_px, std::back_inserter(corners));
  return image_coverage(r.calibration.color, corners);
}

/// NaN if no used view has one.
double median_edge_width(const BoardProblem& problem) {
  std::vector<double> widths;
  for (std::size_t view : used_views(problem))
    if (const double width = problem.observations.views[view].relative_edge_width;
        std::isfinite(width))
      widths.push_back(width);
  return widths.empty() ? std::numeric_limits<double>::quiet_NaN() : median(std::move(widths));
}

json outlier_views(const DetailsInput& r) {
  json names = json::array();
  for (std::size_t view = 0; view < r.problem.used.size(); ++view)
    if (!r.problem.used[view] && r.different[view])
      names.push_back(r.problem.observations.views[view].name);
  return names;
}

json duplicate_views(const DetailsInput& r) {
  json names = json::array();
  for (std::size_t view = 0; view < r.different.size(); ++view)
    if (!r.different[view]) names.push_back(r.problem.observations.views[view].name);
  return names;
}

/// Standard deviations of the priors, in the order of the covariance.
std::vector<double> prior_sigmas(const BoardProblem& problem) {
  std::vector<double> sigmas;
  for (int i : problem.free_color)
    sigmas.push_back(problem.prior.color_sigma[static_cast<std::size_t>(i)]);
  sigmas.insert(sigmas.end(), 2, problem.prior.warp_sigma_m);
  if (problem.samples.empty()) return sigmas;
  const auto append = [&](const auto& values) {
    sigmas.insert(sigmas.end(), values.begin(), values.end());
  };
  append(problem.prior.pose_sigma);
  append(problem.prior.depth_sigma);
  append(problem.prior.correction_sigma);
  if (problem.free_delay) sigmas.push_back(problem.prior.delay_sigma_s);
  return sigmas;
}

json not_identifiable(const DetailsInput& r) {
  json list = json::array();
  const auto priors = prior_sigmas(r.problem);
  for (std::size_t i = 0; i < priors.size(); ++i) {
    if (r.problem.observations.board.is_flat && r.calibration.parameters[i].starts_with("board."))
      continue;
    const double sigma = parameter_sigma(r.calibration, r.calibration.parameters[i]);
    if (!(sigma <= max_sigma_ratio * priors[i]))
      list.push_back({{"parameter", r.calibration.parameters[i]},
                      {"sigma", sigma},
                      {"prior_sigma", priors[i]}});
  }
  return list;
}

json target_deformation(const DetailsInput& r) {
  json offsets_m = json::array();
  for (const auto& o : r.parameters.corner_offsets_m) offsets_m.push_back({o.x(), o.y(), o.z()});
  return {{"chosen", has_free_deformation(r.problem) ? "free" : "ideal"},
          {"bic_gain", number_or_null(r.boards.deformation_bic_gain)},
          {"sigma_m", r.problem.prior.deformation_sigma_m},
          {"offsets_m", offsets_m}};
}

/// Standard deviation of each parameter.
json sigmas(const std::vector<std::string>& parameters, const Eigen::MatrixXd& covariance) {
  json values = json::object();
  for (std::size_t i = 0; i < parameters.size(); ++i)
    values[parameters[i]] = std::sqrt(covariance(Eigen::Index(i), Eigen::Index(i)));
  return values;
}

json depth(const DetailsInput& r) {
  if (r.problem.samples.empty()) return nullptr;
  return {{"samples", r.problem.samples.size()},
          {"sigma_at_1m", r.noise.sigma_at_1m},
          {"exponent", r.noise.exponent},
          {"inflation", r.noise.inflation},
          {"delay", r.problem.free_delay ? "estimated" : "not estimated: the board does not move"},
          {"bias_sigma_at_1m", depth_bias_sigma_m(r.calibration, 1.0)}};
}

json lenses(const ColorFit& color) {
  json list = json::array();
  for (const auto& trial : color.trials) {
    json removed = json::array();
    for (const auto& [parameter, why] : trial.removed)
      removed.push_back({{"parameter", parameter}, {"why", why}});
    list.push_back(
        {{"name", trial.name}, {"bic", number_or_null(trial.bic)}, {"removed", removed}});
  }
  return list;
}

json skipped_images(const BoardObservations& observations) {
  json list = json::array();
  for (const auto& [name, why] : observations.skipped)
    list.push_back({{"name", name}, {"why", why}});
  return list;
}

}  // namespace

json calibration_details(const DetailsInput& r) {
  const auto used = static_cast<int>(std::ranges::count(r.problem.used, true));
  const Verdict verdict = assess_calibration(
      r.calibration,
      {used, r.covariance.inflation, median_edge_width(r.problem), r.boards.change_px()});
  return {{"verdict", grade_name(verdict.grade)},
          {"advice", verdict.advice},
          {"lens", r.color.chosen},
          {"lenses", lenses(r.color)},
          {"target_deformation", target_deformation(r)},
          {"board_models", board_models_json(r.boards)},
          {"corner_sigma_px", r.problem.corner_sigma_px},
          {"sigmas", sigmas(r.calibration.parameters, r.covariance.by_views)},
          {"independent_sigmas", sigmas(r.calibration.parameters, r.covariance.independent)},
          {"view_inflation", r.covariance.inflation},
          {"projection_sigma_px", grid_json(projection_sigma_px(r.calibration))},
          {"coverage", coverage_of_used_views(r)},
          {"not_identifiable", not_identifiable(r)},
          {"views", view_details(r)},
          {"outlier_views", outlier_views(r)},
          {"duplicate_views", duplicate_views(r)},
          {"views_without_board", r.problem.observations.views_without_board},
          {"skipped_images", skipped_images(r.problem.observations)},
          {"depth", depth(r)}};
}

}  // namespace touchtrace
