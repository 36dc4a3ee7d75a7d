#include "calib/rgbd/next_view.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "calib/matrix/decomposition.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/verdict.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd;

constexpr std::array places{0.25, 0.5, 0.75};      ///< of the board's centre
constexpr std::array widths{0.6, 0.35};            ///< of the board, fractions of the image
constexpr double tilt = std::numbers::pi * 2 / 9;  ///< 40 degrees
constexpr std::array<std::array<double, 2>, 5> tilts{
    {{0.0, 0.0}, {tilt, 0.0}, {-tilt, 0.0}, {0.0, tilt}, {0.0, -tilt}}};

/// Information of a view about the calibration.
class ViewInformation {
 public:
  ViewInformation(const RgbdCalibration& calibration, const CalibrationTarget& board)
      : calibration_(calibration),
        observations_(),
        problem_{observations_, {true}, {}, without_prior(), color_parameter_indices(calibration)} {
    observations_.board = board;
    observations_.width = calibration.color.width;
    observations_.height = calibration.color.height;
    parameters_.lens = calibration.color.lens;
    parameters_.color = calibration.color.parameters();
    parameters_.board_warp_m = calibration.board_warp_m;
    problem_.corner_sigma_px = calibration.details.at("corner_sigma_px").get<double>() *
                               calibration.details.at("view_inflation").get<double>();
  }

  /// Information matrix about colour camera and warp; empty if a corner is outside of the image or
  /// the pose is NaN.
  MatrixXd of(const Eigen::Isometry3d& camera_from_board) {
    BoardView view;
    const CalibrationTarget& board = observations_.board;
    for (int corner = 0; corner < board.num_corners(); ++corner) {
      const auto pixel = calibration_.color.project(camera_from_board * board.corner_m(corner));
      if (!is_inside(pixel)) return {};
      view.corners_px.push_back(pixel);
    }
    observations_.views = {std::move(view)};
    const Eigen::AngleAxisd rotation(camera_from_board.linear());
    const Eigen::Vector3d angle_axis = rotation.angle() * rotation.axis();
    const Eigen::Vector3d& position_m = camera_from_board.translation();
    parameters_.camera_from_board = {{angle_axis.x(), angle_axis.y(), angle_axis.z(),
                                      position_m.x(), position_m.y(), position_m.z()}};
    const MatrixXd all = information(problem_, parameters_);
    return schur_complement(all, all.rows() - 6);
  }

 private:
  static Prior without_prior() {
    Prior prior;
    prior.color_sigma.fill(std::numeric_limits<double>::infinity());
    prior.warp_sigma_m = std::numeric_limits<double>::infinity();
    return prior;
  }
  bool is_inside(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= observations_.width - 1.0 &&
           pixel.y() <= observations_.height - 1.0;
  }

  const RgbdCalibration& calibration_;
  BoardObservations observations_;
  BoardProblem problem_;
  RgbdParameters parameters_;
};

/// All candidates; the last member is not set.
std::vector<NextView> candidates(const RgbdCalibration& c, const CalibrationTarget& board,
                                 double sigma_px) {
  const double board_width_m = board.size_m().x();
  std::vector<NextView> views;
  for (const double width : widths)
    for (const double row : places)
      for (const double column : places)
        for (const auto& [x, y] : tilts)
          views.push_back({column, row, c.color.fx * board_width_m / (width * c.color.width), x, y,
                           sigma_px, std::numeric_limits<double>::infinity()});
  return views;
}

}  // namespace

Eigen::Isometry3d camera_from_board(const NextView& view, const Camera& camera,
                                    const CalibrationTarget& board) {
  const Eigen::Vector3d ray =
      camera.unproject({view.column * camera.width, view.row * camera.height}).normalized();
  const Eigen::Quaterniond ray_from_z(1.0 + ray.z(), -ray.y(), ray.x(), 0.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = ray_from_z.normalized() *
                  Eigen::AngleAxisd(view.tilt_x_rad, Eigen::Vector3d::UnitX()) *
                  Eigen::AngleAxisd(view.tilt_y_rad, Eigen::Vector3d::UnitY()).matrix();
  pose.translation() =
      view.distance_m * ray - 0.5 * pose.linear() * board.corner_m(board.num_corners() - 1);
  return pose;
}

std::optional<NextView> find_next_view(const RgbdCalibration& calibration,
                                       const CalibrationTarget& board) {
  ViewInformation view_information(calibration, board);
  RgbdCalibration then = calibration;
  const Index size = static_cast<Index>(color_parameter_indices(calibration).size()) + 2;
  const Cholesky covariance(calibration.covariance.topLeftCorner(size, size));
  if (!covariance.is_valid()) return {};
  const MatrixXd now = covariance.inverse_corner(size);
  std::optional<NextView> best;
  const double sigma_px = projection_sigma_quantile_px(calibration, judged_image_fraction);
  for (NextView view : candidates(calibration, board, sigma_px)) {
    const MatrixXd added = view_information.of(camera_from_board(view, calibration.color, board));
    if (added.size() == 0) continue;
    then.covariance = Cholesky(now + added).inverse_corner(size);
    view.then_px = projection_sigma_quantile_px(then, judged_image_fraction);
    if (!best || view.then_px < best->then_px) best = view;
  }
  return best;
}

std::string describe(const NextView& view) {
  const char* row = view.row < 0.5 ? "upper " : view.row > 0.5 ? "lower " : "";
  const char* column = view.column < 0.5 ? "left" : view.column > 0.5 ? "right" : "middle";
  std::string turned = "facing the camera";
  const auto away = [](const char* side) {
    return fmt::format("its {} side turned {:.0f} degrees away", side,
                       tilt * 180.0 / std::numbers::pi);
  };
  // Board frame: x right, y down, z away from the camera.
  if (view.tilt_x_rad != 0.0) turned = away(view.tilt_x_rad > 0.0 ? "lower" : "upper");
  if (view.tilt_y_rad != 0.0) turned = away(view.tilt_y_rad > 0.0 ? "left" : "right");
  return fmt::format("in the {}{} of the image, {:.2f} m away, {}", row, column, view.distance_m,
                     turned);
}

}  // namespace touchtrace
