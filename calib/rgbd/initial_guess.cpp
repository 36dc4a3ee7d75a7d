#include "calib/rgbd/initial_guess.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/lens_choice.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

/// Fractions of the image width. An equidistant lens with a field of view of 180 degrees has 0.32.
constexpr double fisheye_focal_lengths[] = {0.2, 0.25, 0.32, 0.4, 0.5, 0.65, 0.8, 1.0};
constexpr std::size_t max_views_for_focal_length = 7;
constexpr double max_ray_tangent = 6.0;  ///< 80 degrees; wider rays hardly constrain a pose

std::vector<cv::Point3f> board_points(const BoardView& view, const CalibrationTarget& board) {
  std::vector<cv::Point3f> points;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const Eigen::Vector3f corner = board.corner_m(view.corner_id(i)).cast<float>();
    points.emplace_back(corner.x(), corner.y(), corner.z());
  }
  return points;
}

std::vector<cv::Point2f> image_points(const BoardView& view) {
  std::vector<cv::Point2f> points;
  for (const auto& corner : view.corners_px)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  return points;
}

/// Replaces a degenerate estimate, as of views that are all parallel to the image, by the width.
double plausible_focal_length(double focal_px, int width) {
  const double typical_px = 1.0 * width;
  return std::isfinite(focal_px) && focal_px > 0.3 * width && focal_px < 10.0 * width ? focal_px
                                                                                      : typical_px;
}

double focal_length_from_homographies(const BoardObservations& observations) {
  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::vector<cv::Point2f>> images;
  for (const auto& view : observations.views) {
    boards.push_back(board_points(view, observations.board));
    images.push_back(image_points(view));
  }
  const cv::Matx33d camera =
      cv::initCameraMatrix2D(boards, images, {observations.width, observations.height}, 1.0);
  return plausible_focal_length(camera(0, 0), observations.width);
}

}  // namespace

std::array<double, 6> initial_pose(const BoardView& view, const CalibrationTarget& board,
                                   const Camera& camera) {
  std::vector<cv::Point3f> on_board;
  std::vector<cv::Point2f> rays;
  const auto all = board_points(view, board);
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const Eigen::Vector3d ray = camera.unproject(view.corners_px[i]);
    if (!(ray.head<2>().norm() < max_ray_tangent)) continue;
    on_board.push_back(all[i]);
    rays.emplace_back(static_cast<float>(ray.x()), static_cast<float>(ray.y()));
  }
  cv::Vec3d rotation, translation(0.0, 0.0, 1.0);
  try {
    if (rays.size() >= 4)
      cv::solvePnP(on_board, rays, cv::Matx33d::eye(), cv::noArray(), rotation, translation, false,
                   cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};  // degenerate, such as collinear corners
  }
  return {rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2]};
}

namespace {

RgbdParameters guess_for_focal_length(double focal_px, const BoardObservations& o,
                                      const Lens& lens) {
  Camera camera{.width = o.width, .height = o.height};
  camera.lens = lens;
  camera.fx = camera.fy = focal_px;
  camera.cx = 0.5 * (o.width - 1), camera.cy = 0.5 * (o.height - 1);
  RgbdParameters parameters;
  parameters.lens = lens;
  parameters.color = camera.parameters();
  for (const auto& view : o.views)
    parameters.camera_from_board.push_back(initial_pose(view, o.board, camera));
  return parameters;
}

/// RMS of the median view, robust against views with a wrong pose.
double median_view_rms_px(const BoardObservations& o, const RgbdParameters& parameters) {
  std::vector<double> values;
  for (std::size_t view = 0; view < o.views.size(); ++view)
    values.push_back(rms(corner_residuals(o, view, parameters)));
  return median(std::move(values));
}

/// Evenly spaced subset of the views; the focal length is right if most of them are good.
BoardObservations subsample_views(const BoardObservations& o) {
  const std::size_t stride = 1 + o.views.size() / max_views_for_focal_length;
  BoardObservations few{o.board, o.width, o.height, {}, {}, {}};
  for (std::size_t i = 0; i < o.views.size(); i += stride) few.views.push_back(o.views[i]);
  return few;
}

}  // namespace

RgbdParameters initial_guess(const BoardObservations& o, const Lens& lens) {
  if (is_perspective(lens))
    return guess_for_focal_length(focal_length_from_homographies(o), o, lens);
  const BoardObservations few = subsample_views(o);
  double best_px = o.width, min_rms_px = std::numeric_limits<double>::infinity();
  for (double relative_focal_length : fisheye_focal_lengths) {
    const double focal_px = relative_focal_length * o.width;
    const double rms_px = median_view_rms_px(few, guess_for_focal_length(focal_px, few, lens));
    if (rms_px < min_rms_px) best_px = focal_px, min_rms_px = rms_px;
  }
  return guess_for_focal_length(best_px, o, lens);
}

}  // namespace touchtrace
