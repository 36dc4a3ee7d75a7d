#pragma once

#include <memory>

#include "calib/rgbd/calibration.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/label/label.h"
#include "pipeline/scene/objects/object.h"

namespace touchtrace::study {

/// Half a minute to be simulated, rendered, calibrated and labelled like a user's recording.
struct RenderedScene {
  std::string activity;
  scene::ObjectSpec object;
  std::uint64_t seed = 1;
  int width = 640, height = 480;
};

/// Stretches of video in which something stands before the camera.
struct Cover {
  double from_s, to_s;  ///< host's clock
};

/// A rendered scene, on disk as long as this lives.
class RenderedRecording {
 public:
  explicit RenderedRecording(const RenderedScene& scene);

  /// Nothing of the truth is read. A cover hides all of the picture.
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
