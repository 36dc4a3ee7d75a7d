#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/label/matching.h"

namespace touchtrace::label {
namespace {

TEST(LabelMatching, RefusesACalibrationOfAnotherImageSize) {
  RgbdCalibration calibration;
  calibration.color.width = 640, calibration.color.height = 480;
  CameraInfo camera;
  camera.width = 640, camera.height = 480;
  camera.depth_width = 320, camera.depth_height = 240;
  EXPECT_NO_THROW(require_matching(calibration, camera));
  calibration.depth = calibration.color;
  EXPECT_THROW(require_matching(calibration, camera), Error);
  calibration.depth->width = 320, calibration.depth->height = 240;
  EXPECT_NO_THROW(require_matching(calibration, camera));
  camera.width = 1280;
  try {
    require_matching(calibration, camera);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "calibration of the colour camera is for images of 640 x 480, the recording has "
                 "1280 x 480");
  }
}

}  // namespace
}  // namespace touchtrace::label
