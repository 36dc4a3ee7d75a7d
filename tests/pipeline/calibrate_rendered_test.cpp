#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "engine/cl/device.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/simulate/video.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

RgbdParameters parameters_of(const scene::RgbdCamera& camera) {
  RgbdParameters truth;
  truth.lens = camera.color.lens;
  truth.color = camera.color.parameters();
  std::copy_n(camera.depth.parameters().begin(), 4, truth.depth.begin());
  const Eigen::AngleAxisd angle_axis(camera.depth_from_color.linear());
  const Eigen::Vector3d rotation = angle_axis.angle() * angle_axis.axis();
  const Eigen::Vector3d translation = camera.depth_from_color.translation();
  truth.depth_from_color = {rotation.x(),    rotation.y(),    rotation.z(),
                            translation.x(), translation.y(), translation.z()};
  truth.depth_correction = {camera.sensor.scale, camera.sensor.offset_m};
  return truth;
}

BoardObservations rendered_views(const scene::SceneOptions& options,
                                 const scene::RgbdCamera& camera) {
  Runtime runtime(choose_device("cpu"));
  const BoardInfo board;
  scene::Video video(runtime, camera, scene::make_camera_clock(options), options, board);
  return detect_board_views(scene::camera_info(camera, options), board, video.board_views(),
                            [&](std::size_t i) { return video.board_view(i); });
}

TEST(CalibrateRendered, ErrorsAreWithinTheirOwnStandardDeviations) {
  const scene::SceneOptions options{.image_width = 320, .image_height = 240, .board_views = 20};
  const auto camera = scene::make_camera(options);
  const auto observations = rendered_views(options, camera);
  EXPECT_GE(observations.views.size(), 18u);
  const RgbdCalibration c = calibrate(observations);
  EXPECT_EQ(c.details["verdict"], "GOOD");
  EXPECT_LT(c.rms_px, 0.1);
  const Eigen::VectorXd error = errors(c, parameters_of(camera));
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 3.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

}  // namespace
}  // namespace touchtrace
