#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/rgbd/board_models.h"
#include "calib/rig/calibrate_rig.h"
#include "engine/base/error.h"
#include "tests/verify/calib/simulated_rig.h"

namespace touchtrace {
namespace {

const CalibrationOptions one_lens{.lenses = {"radtan4"}};

std::vector<RigInput> observed(const SimulatedRig& rig, std::uint64_t seed = 1) {
  RandomStream random(seed, "rig test");
  return observe(rig, random);
}

/// Error of a camera's pose in standard deviations: e' C^-1 e / 6.
double pose_nees(const RigCalibration& c, const SimulatedRig& truth, std::size_t camera) {
  const auto error = pose_error(c, truth, camera);
  return error.dot(pose_covariance(c, camera).ldlt().solve(error)) / 6.0;
}

/// 99.99 % of a chi-squared variate of six degrees of freedom, over six.
constexpr double max_pose_nees = 27.9 / 6.0;

/// 20 rigs: standard error sqrt(2 / 120) = 0.13; 4 of these.
TEST(Rig, CovarianceOfTheRelativePoseIsConsistent) {
  EXPECT_NEAR(rig_pose_nees(simulated_rig(12), 20), 1.0, 4.0 * std::sqrt(2.0 / 120.0));
}

TEST(Rig, IntrinsicsOfEachCameraAreThoseOfTheJointFit) {
  const SimulatedRig rig = simulated_rig(12);
  const auto inputs = observed(rig);
  const RigCalibration joint = calibrate_rig(inputs, one_lens);
  for (std::size_t i = 0; i < 2; ++i) {
    const RgbdCalibration &c = joint.cameras[i],
                          alone = calibrate(inputs[i].observations, one_lens);
    const Eigen::VectorXd error = errors(c, rig.cameras[i].truth);
    EXPECT_LT(error.dot(c.covariance.ldlt().solve(error)) / double(error.size()), 3.0);
    EXPECT_LT(c.covariance(0, 0), alone.covariance(0, 0));  // the other camera tells of the poses
    EXPECT_EQ(c.details["sigmas"]["color.fx"].get<double>(), std::sqrt(c.covariance(0, 0)));
    EXPECT_EQ(c.details["verdict"], "GOOD");
  }
}

/// A rig takes the models of the board from the calibrations of its cameras.
TEST(Rig, BoardModelsAreReadBack) {
  BoardModels models;
  models.flat = {1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(board_models_of(board_models_json(models)).change_px(), Eigen::Vector4d::Zero());
  models.free_corners = {2.0, 4.0, 6.0, 8.0};
  EXPECT_EQ(board_models_of(board_models_json(models)).change_px(), models.flat);
  models.warped = {2.0, 4.0, 6.0, 7.0};
  EXPECT_EQ(board_models_of(board_models_json(models)).change_px(), Eigen::Vector4d(0, 0, 0, 1));
}

TEST(Rig, WarpOfAFlatBoardIsNotEstimated) {
  auto inputs = observed(simulated_rig(12));
  for (RigInput& input : inputs) input.observations.board.is_flat = true;
  const RigCalibration c = calibrate_rig(inputs, one_lens);
  EXPECT_LT(std::abs(c.cameras[0].board_warp_m[0]), 1e-6);
  EXPECT_LT(std::abs(c.cameras[1].board_warp_m[1]), 1e-6);
}

TEST(Rig, FrameWithAMovedBoardIsExcluded) {
  const SimulatedRig rig = simulated_rig(12);
  auto inputs = observed(rig);
  for (auto& corner : inputs[1].observations.views[3].corners_px) corner.x() += 4.0;
  std::swap(inputs[1].observations.views[5].corners_px, inputs[1].observations.views[6].corners_px);
  std::vector<std::string> moved;
  for (int view : {3, 5, 6}) moved.push_back(inputs[1].observations.views[std::size_t(view)].name);
  const RigCalibration c = calibrate_rig(inputs, one_lens);
  EXPECT_EQ(c.details["outlier_frames"].get<std::vector<std::string>>(), moved);
  EXPECT_LT(pose_nees(c, rig, 1), max_pose_nees);
}

TEST(Rig, FramesOfOneCameraHelpToCalibrateIt) {
  const SimulatedRig rig = simulated_rig(20);
  auto inputs = observed(rig);
  const double all_px = calibrate_rig(inputs, one_lens).details["sigmas"]["cam0.fx"];
  inputs[1].observations.views.resize(6);
  const RigCalibration c = calibrate_rig(inputs, one_lens);
  inputs[0].observations.views.resize(8);
  const double shared_px = calibrate_rig(inputs, one_lens).details["sigmas"]["cam0.fx"];
  EXPECT_EQ(c.details["frames"].size(), 20u);
  EXPECT_LT(c.details["sigmas"]["cam0.fx"].get<double>(), 0.8 * shared_px);
  EXPECT_LT(all_px, shared_px);
  EXPECT_LT(pose_nees(c, rig, 1), max_pose_nees);
}

TEST(Rig, CamerasAreChained) {
  const SimulatedRig rig = simulated_rig(24, 3);
  auto inputs = observed(rig);
  // The first and the last camera share no frame.
  std::erase_if(inputs[0].observations.views,
                [](const BoardView& view) { return std::stoi(view.name.substr(5)) >= 14; });
  std::erase_if(inputs[2].observations.views,
                [](const BoardView& view) { return std::stoi(view.name.substr(5)) < 14; });
  const RigCalibration c = calibrate_rig(inputs, one_lens);
  EXPECT_LT(pose_nees(c, rig, 1), max_pose_nees);
  EXPECT_LT(pose_nees(c, rig, 2), max_pose_nees);
}

/// The detector may number the corners of a symmetric board from either end.
TEST(Rig, ViewsOfASymmetricBoardAreTurned) {
  SimulatedRig rig = simulated_rig(12);
  for (auto& boards : rig.cameras) {
    boards.clean.board = CalibrationTarget{9, 5, 0.025};
    for (auto& view : boards.clean.views) view.corners_px.resize(45);
  }
  auto inputs = observed(rig);
  const RigCalibration straight = calibrate_rig(inputs, one_lens);
  for (std::size_t i = 0; i < inputs[1].observations.views.size(); ++i)
    std::ranges::reverse(inputs[1].observations.views[i].corners_px);
  const RigCalibration turned = calibrate_rig(inputs, one_lens);
  EXPECT_TRUE(turned.details["outlier_frames"].empty());
  EXPECT_LT(pose_nees(turned, rig, 1), max_pose_nees);
  EXPECT_NEAR(turned.camera_from_rig[1].translation().x(),
              straight.camera_from_rig[1].translation().x(), 1e-5);
}

/// Both pixels have noise of sigma in each direction, so that a distance has sqrt(2) sigma.
TEST(Rig, HeldOutEpipolarErrorIsTheNoise) {
  SimulatedRig rig = simulated_rig(16);
  for (auto& boards : rig.cameras) boards.corner_sigma_px = 0.2;
  const RigCalibration c =
      calibrate_rig(observed(rig), {.lenses = {"radtan4"}, .cross_validate = true});
  ASSERT_EQ(c.details["epipolar"].size(), 1u);
  const double ratio = c.details["epipolar"][0]["rms_px"].get<double>() / (0.2 * std::sqrt(2.0));
  EXPECT_GT(ratio, 0.95);
  EXPECT_LT(ratio, 1.15);  // 22 estimated parameters, 12 frames
}

TEST(Rig, NeedsSharedFrames) {
  auto inputs = observed(simulated_rig(12));
  auto& views = inputs[1].observations.views;
  views.resize(5);  // fewer than the first camera's: not paired by order
  for (std::size_t i = 0; i < views.size(); ++i) views[i].name = std::to_string(100 + i);
  EXPECT_THROW(calibrate_rig(inputs, one_lens), Error);
  inputs.pop_back();
  EXPECT_THROW(calibrate_rig(inputs, one_lens), Error);
}

}  // namespace
}  // namespace touchtrace
