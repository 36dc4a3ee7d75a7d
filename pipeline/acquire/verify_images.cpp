#include "pipeline/acquire/verify_images.h"

#include <cmath>
#include <filesystem>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/verify_calibration.h"
#include "engine/base/error.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace {
namespace {

constexpr const char* photographs = "/usr/share/doc/opencv-doc/examples/data";
constexpr double left_focal_px = 533.6;  ///< of mrcal 2.2: 533.5 to 533.8

RgbdCalibration calibrate_photographs(const std::string& side) {
  return calibrate(
      board_views_of_images(std::string(photographs) + "/" + side + "0?.jpg", Chessboard{}),
      {.cross_validate = true});
}

double held_out_ratio(const RgbdCalibration& c) {
  return c.details["held_out"]["held_out_rms_px"].get<double>() / c.rms_px;
}

void emit_photographs(const std::function<void(Figure)>& emit) {
  const RgbdCalibration left = calibrate_photographs("left");
  emit(at_most("opencv-doc left01..09, RMS", left.rms_px, "px", 0.24));
  emit(at_most("opencv-doc left01..09, fx from mrcal's 533.6",
               std::abs(left.color.fx - left_focal_px), "px", 1.5));
  emit(at_least("opencv-doc left01..09, views with a board", double(left.details["views"].size()),
                "", 8.0));
  emit(at_most("opencv-doc left01..09, held-out over training RMS", held_out_ratio(left), "", 1.1));
  const RgbdCalibration right = calibrate_photographs("right");
  emit(at_most("opencv-doc right01..09, RMS", right.rms_px, "px", 0.24));
  emit(at_most("opencv-doc right01..09, held-out over training RMS", held_out_ratio(right), "",
               1.1));
}

}  // namespace

Verification calibration_verification() {
  return [](const std::function<void(Figure)>& emit) {
    if (!std::filesystem::is_directory(photographs))
      throw data_error("the sample photographs of OpenCV are not installed",
                       "apt-get install opencv-doc");
    emit_photographs(emit);
    verify_simulated_calibration(emit);
  };
}

}  // namespace touchtrace
