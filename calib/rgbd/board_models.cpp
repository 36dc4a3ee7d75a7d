#include "calib/rgbd/board_models.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/rgbd/target_deformation.h"

namespace touchtrace {
namespace {

Eigen::Vector4d core_intrinsics(const RgbdParameters& parameters) {
  return Eigen::Map<const Eigen::Vector4d>(parameters.color.data());
}

Eigen::Vector4d mean_given_no_warp(const BoardProblem& problem, const RgbdParameters& parameters) {
  const Eigen::MatrixXd c = covariance(problem, parameters);
  if (c.size() == 0) return Eigen::Vector4d::Constant(BoardModels::unknown);
  const auto warp = static_cast<Eigen::Index>(problem.free_color.size());
  const Eigen::Matrix2d inverse = c.block<2, 2>(warp, warp).inverse();
  return core_intrinsics(parameters) -
         c.block<4, 2>(0, warp) *
             (inverse * Eigen::Map<const Eigen::Vector2d>(parameters.board_warp_m.data()));
}

nlohmann::json list(const Eigen::Vector4d& values) {
  if (!values.allFinite()) return nullptr;
  return std::vector<double>(values.begin(), values.end());
}

Eigen::Vector4d values_of(const nlohmann::json& list) {
  Eigen::Vector4d values = Eigen::Vector4d::Constant(BoardModels::unknown);
  if (list.is_array()) std::ranges::copy(list, values.begin());
  return values;
}

}  // namespace

Eigen::Vector4d BoardModels::change_px() const {
  if (!free_corners) return Eigen::Vector4d::Zero();
  return *free_corners - (warped.allFinite() ? warped : flat);
}

BoardModels fit_board(BoardProblem& problem, RgbdParameters& parameters, bool target_deformation) {
  BoardModels models;
  models.flat = models.warped = core_intrinsics(parameters);
  if (problem.observations.board.is_flat)
    models.warped.setConstant(BoardModels::unknown);
  else
    models.flat = mean_given_no_warp(problem, parameters);
  if (!target_deformation) return models;
  models.deformation_bic_gain = fit_target_deformation(problem, parameters);
  if (has_free_deformation(problem)) models.free_corners = core_intrinsics(parameters);
  return models;
}

nlohmann::json board_models_json(const BoardModels& models) {
  return {{"flat", list(models.flat)},
          {"warped", list(models.warped)},
          {"free_corners", models.free_corners ? list(*models.free_corners) : nlohmann::json()}};
}

BoardModels board_models_of(const nlohmann::json& details) {
  BoardModels models{values_of(details.at("flat")), values_of(details.at("warped")), {}};
  if (details.at("free_corners").is_array())
    models.free_corners = values_of(details["free_corners"]);
  return models;
}

}  // namespace touchtrace
