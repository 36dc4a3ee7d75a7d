#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// fx, fy, cx, cy [px] of the colour camera for each model of the board.
struct BoardModels {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  /// To first order: the mean given a warp of 0. NaN if the covariance is singular.
  Eigen::Vector4d flat = Eigen::Vector4d::Constant(unknown);
  Eigen::Vector4d warped = Eigen::Vector4d::Constant(unknown);  ///< NaN: the board is flat
  std::optional<Eigen::Vector4d> free_corners;                  ///< nullopt: not chosen
  /// TargetDeformation::bic_gain; NaN if it was not tried.
  double deformation_bic_gain = unknown;

  /// Change of fx, fy, cx, cy by free corners, from the next simpler model; 0 without free corners,
  /// NaN if that model is unknown.
  Eigen::Vector4d change_px() const;
};

/// Completes a solved problem of the colour camera by fit_target_deformation(), if
/// `target_deformation`, and compares the models of the board.
BoardModels fit_board(BoardProblem& problem, RgbdParameters& parameters, bool target_deformation);

/// {"flat": [fx, fy, cx, cy], "warped": .., "free_corners": ..}; null: not computed.
nlohmann::json board_models_json(const BoardModels& models);
/// The models of board_models_json().
BoardModels board_models_of(const nlohmann::json& details);

}  // namespace touchtrace
