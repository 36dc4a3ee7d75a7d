#include "calib/rig/rig_details.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calib/matrix/decomposition.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/details.h"
#include "calib/rgbd/verdict.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd;
using nlohmann::json;

constexpr double judged_distance_m = 1.0;  ///< as for depth in verdict.h

std::size_t num_shared_frames(const RigProblem& problem, std::size_t camera) {
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    count += problem.used[frame] && problem.frames[frame].views[camera] &&
             problem.frames[frame].num_views() > 1;
  return count;
}

void assess_camera(const RgbdCalibration& camera, const std::string& name, Verdict& verdict) {
  for (Grade grade : {Grade::good, Grade::weak, Grade::bad})
    if (camera.details["verdict"] == grade_name(grade))
      verdict.grade = std::max(verdict.grade, grade);
  for (const auto& advice : camera.details["advice"])
    verdict.advice.push_back(name + ": " + advice.get<std::string>());
}

/// Largest standard deviation in any direction.
double max_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(SymmetricEigen(covariance).values.maxCoeff());
}

/// The error of a projection at 1 m that the pose's error makes has the limits of the projection
/// map.
void assess_pose(const RigCalibration& rig, std::size_t camera, Verdict& verdict) {
  const auto pose = pose_covariance(rig, camera);
  const Camera& c = rig.cameras[camera].color;
  const double rotation_rad = max_sigma(pose.topLeftCorner<3, 3>()),
               translation_m = max_sigma(pose.bottomRightCorner<3, 3>());
  const double shift_px = c.fx * std::max(rotation_rad, translation_m / judged_distance_m);
  apply_limits(
      verdict, shift_px / c.width, good_projection_sigma, weak_projection_sigma,
      fmt::format("{}: the standard deviations of its pose are {:.2f} mm and {:.3f} "
                  "degrees: show the board to both cameras, near and tilted",
                  rig.names[camera], 1e3 * translation_m, rotation_rad * 180.0 / std::numbers::pi));
}

Verdict assess_rig(const RigSolution& s, const RigCalibration& rig) {
  Verdict verdict;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    assess_camera(rig.cameras[i], rig.names[i], verdict);
    const auto frames = num_shared_frames(s.problem, i);
    apply_limits(verdict, -static_cast<double>(frames), -8, -4,
                 fmt::format("{}: only {} frames are shared with another camera: show the board to "
                             "both at once in 10 to 20 poses",
                             rig.names[i], frames));
    if (i > 0) assess_pose(rig, i, verdict);
  }
  for (const auto& error : s.epipolar)
    apply_limits(verdict, error.rms_px, 0.5, 1.5,
                 fmt::format("the epipolar error of {} and {} is {:.2f} px: trigger both cameras "
                             "at once, or hold the board still",
                             rig.names[error.first], rig.names[error.second], error.rms_px));
  return verdict;
}

json relative_poses(const RigCalibration& rig) {
  json list = json::array();
  for (std::size_t i = 1; i < rig.cameras.size(); ++i) {
    const RelativePose pose = relative_pose(rig, i);
    list.push_back({{"camera", rig.names[i]},
                    {"baseline_m", pose.baseline_m},
                    {"baseline_sigma_m", pose.baseline_sigma_m},
                    {"rotation_rad", pose.rotation_rad},
                    {"rotation_sigma_rad", pose.rotation_sigma_rad}});
  }
  return list;
}

json frames_json(const RigSolution& s, const RigCalibration& rig) {
  json list = json::array();
  for (std::size_t frame = 0; frame < s.problem.frames.size(); ++frame) {
    const RigFrame& f = s.problem.frames[frame];
    json images = json::object();
    for (std::size_t i = 0; i < rig.names.size(); ++i)
      if (f.views[i]) images[rig.names[i]] = s.problem.observations[i].views[*f.views[i]].name;
    list.push_back({{"name", f.name},
                    {"used", bool(s.problem.used[frame])},
                    {"images", images},
                    {"rms_sigmas", rms(frame_residuals(s.problem, s.parameters, frame))}});
  }
  return list;
}

json outlier_frames(const RigProblem& problem) {
  json names = json::array();
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (!problem.used[frame]) names.push_back(problem.frames[frame].name);
  return names;
}

json epipolar_json(const RigSolution& s, const RigCalibration& rig) {
  json list = json::array();
  for (const auto& error : s.epipolar)
    list.push_back({{"cameras", {rig.names[error.first], rig.names[error.second]}},
                    {"rms_px", std::isfinite(error.rms_px) ? json(error.rms_px) : json()},
                    {"frames", error.num_frames}});
  return list;
}

/// Rows and columns of a camera's intrinsics and the board's warp.
MatrixXd camera_covariance(const RigProblem& problem, std::size_t camera, const MatrixXd& all) {
  Index first = 0;
  for (std::size_t i = 0; i < camera; ++i) first += static_cast<Index>(problem.free[i].size());
  const auto size = static_cast<Index>(problem.free[camera].size());
  std::vector<Index> indices;
  for (Index i = 0; i < size; ++i) indices.push_back(first + i);
  indices.insert(indices.end(), {all.rows() - 2, all.rows() - 1});
  return all(indices, indices);
}

/// [views] whether a frame holds the view; with `only_used`, a used one.
std::vector<bool> paired_views(const RigProblem& problem, std::size_t camera, bool only_used) {
  std::vector<bool> paired(problem.observations[camera].views.size(), false);
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (const auto view = problem.frames[frame].views[camera])
      paired[*view] = problem.used[frame] || !only_used;
  return paired;
}

}  // namespace

json rig_details(const RigSolution& s, const RigCalibration& rig) {
  const Verdict verdict = assess_rig(s, rig);
  json sigmas = json::object();
  for (std::size_t i = 0; i < rig.parameters.size(); ++i)
    sigmas[rig.parameters[i]] = std::sqrt(rig.covariance(Index(i), Index(i)));
  return {{"verdict", grade_name(verdict.grade)},
          {"advice", verdict.advice},
          {"relative_poses", relative_poses(rig)},
          {"sigmas", sigmas},
          {"frame_inflation", s.covariance.inflation},
          {"epipolar", epipolar_json(s, rig)},
          {"frames", frames_json(s, rig)},
          {"outlier_frames", outlier_frames(s.problem)}};
}

RgbdCalibration joint_calibration(const RigSolution& s, std::size_t camera,
                                  const RgbdCalibration& alone) {
  const BoardObservations& o = s.problem.observations[camera];
  const RgbdParameters p = single_camera(s.problem, s.parameters, camera);
  const auto used = paired_views(s.problem, camera, true),
             paired = paired_views(s.problem, camera, false);
  BoardProblem problem{o, used, {}, s.problem.priors[camera], s.problem.free[camera]};
  problem.corner_sigma_px = s.problem.corner_sigma_px[camera];
  problem.prior.deformation_sigma_m = s.problem.deformation_sigma_m;
  const ViewCovariance covariance{camera_covariance(s.problem, camera, s.covariance.independent),
                                  camera_covariance(s.problem, camera, s.covariance.by_views),
                                  s.covariance.inflation};
  RgbdCalibration joint = alone;
  joint.color = color_camera(o, p);
  joint.board_warp_m = p.board_warp_m;
  joint.rms_px = rms_of_used_views(o, used, p);
  joint.covariance = covariance.by_views;
  const auto& gain = alone.details["target_deformation"]["bic_gain"];
  BoardModels boards = board_models_of(alone.details["board_models"]);
  if (gain.is_number()) boards.deformation_bic_gain = gain;
  joint.details = calibration_details(
      {problem, p, joint, covariance, ColorFit{}, DepthNoise{}, paired, boards});
  for (const char* key : {"lens", "lenses", "duplicate_views", "held_out", "solving"})
    if (alone.details.contains(key)) joint.details[key] = alone.details[key];
  for (const auto& name : alone.details["outlier_views"])
    joint.details["outlier_views"].push_back(name);
  for (std::size_t view = 0; view < paired.size(); ++view)
    if (!paired[view]) joint.details["views"][view] = alone.details["views"][view];
  return joint;
}

}  // namespace touchtrace
