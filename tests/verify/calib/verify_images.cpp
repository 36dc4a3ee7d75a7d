#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/target_deformation.h"
#include "engine/base/error.h"
#include "pipeline/acquire/board_views.h"
#include "tests/verify/calib/verify_calibration.h"
#include "tests/verify/verifications.h"

namespace touchtrace {
namespace {

constexpr const char* photographs = "/usr/share/doc/opencv-doc/examples/data";
constexpr double left_focal_px = 533.6;  ///< by mrcal 2.2: 533.5 to 533.8

/// Calibration of the left or right camera; both saw the same board.
struct Photographs {
  std::string name;
  RgbdCalibration calibration;
  IdealBoard ideal;

  double held_out_rms_px() const {
    return calibration.details["held_out"]["held_out_rms_px"].get<double>();
  }
};

Photographs calibrate_photographs(const std::string& side) {
  const auto views =
      board_views_from_images({photographs + ("/" + side) + "0?.jpg"}, CalibrationTarget{});
  return {"opencv-doc " + side + "01..09, ", calibrate(views, {.cross_validate = true}),
          calibrate_with_ideal_board(views, {})};
}

void emit_errors(const Photographs& p, const std::function<void(Figure)>& emit) {
  const double held_out_px = p.held_out_rms_px(), ideal_px = p.ideal.held_out_rms_px;
  emit(at_most(p.name + "RMS", p.calibration.rms_px, "px", 0.24));
  emit(at_most(p.name + "held-out over training RMS", held_out_px / p.calibration.rms_px, "", 1.1));
  emit(reported(p.name + "held-out RMS", held_out_px, "px"));
  emit(reported(p.name + "held-out RMS with the ideal board", ideal_px, "px"));
  emit(at_most(p.name + "held-out RMS over the ideal board's", held_out_px / ideal_px, "", 1.0));
}

/// Offsets of the corners from the ideal board after removing pose and scale: [3, corners].
Eigen::Matrix3Xd target_shape(const RgbdCalibration& calibration) {
  const CalibrationTarget board;
  const RgbdParameters found = board_parameters(calibration);
  Eigen::Matrix3Xd ideal(3, board.num_corners()), corners = ideal;
  for (int i = 0; i < board.num_corners(); ++i) {
    ideal.col(i) = board.corner_m(i);
    corners.col(i) = deformed_corner_m(board, i, found);
  }
  const Eigen::Affine3d similarity(Eigen::umeyama(corners, ideal));
  return similarity * corners - ideal;
}

/// Smallest correlation of the three directions.
double min_correlation(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.cwiseProduct(b).rowwise().sum().array() /
          (a.rowwise().norm().array() * b.rowwise().norm().array()))
      .minCoeff<Eigen::PropagateNaN>();
}

void emit_photographs(const std::function<void(Figure)>& emit) {
  const Photographs left = calibrate_photographs("left"), right = calibrate_photographs("right");
  emit_errors(left, emit);
  emit(at_most(left.name + "fx from mrcal's 533.6",
               std::abs(left.calibration.color.fx - left_focal_px), "px", 1.5));
  emit(at_least(left.name + "views with a board", double(left.calibration.details["views"].size()),
                "", 8.0));
  emit_errors(right, emit);
  emit(at_least("opencv-doc, correlation of the deformation from left and right",
                min_correlation(target_shape(left.calibration), target_shape(right.calibration)),
                "", 0.9));
}

}  // namespace

Verification calibration_verification() {
  return [](const std::function<void(Figure)>& emit) {
    if (!std::filesystem::is_directory(photographs))
      throw data_error(
          std::string("no folder ") + photographs + " with OpenCV's sample photographs",
          "apt-get install opencv-doc");
    emit_photographs(emit);
    verify_simulated_calibration(emit);
  };
}

}  // namespace touchtrace
