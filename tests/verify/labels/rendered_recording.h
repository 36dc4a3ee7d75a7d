#pragma once

#include <memory>

#include "calib/rgbd/calibration.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/label/label.h"
#include "pipeline/scene/objects/object.h"

namespace touchtrace::study {

/// Half a minute of a simulated scene.
struct RenderedScene {
  std::string activity;
  scene::ObjectSpec object;
  std::uint64_t seed = 1;
  int width = 640, height = 480;
};

/// Interval in which something covers the camera's whole image.
struct Cover {
  double from_s, to_s;  ///< host's clock
};

/// Simulated and calibrated recording, on disk during the lifetime of this object.
class RenderedRecording {
 public:
  explicit RenderedRecording(const RenderedScene& scene);

  /// Labels the recording without its truth, with covered intervals.
  Labels label(const std::string& tracker, const std::vector<Cover>& covers = {}) const;
  const Recording& recording() const { return reader_->recording(); }
  const Truth& truth() const { return truth_; }

 private:
  ScratchFolder folder_;
  std::unique_ptr<RecordingReader> reader_;
  Truth truth_;
  RgbdCalibration calibration_;
};

}  // namespace touchtrace::study
