#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/label/surface.h"

namespace cv {
class Tracker;
}

namespace touchtrace::label {

/// The colour image where the moving surface is, black elsewhere.
struct MaskedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height, width, 3]
};

MaskedImage masked_image(const RgbdFrame& frame, const Surface& surface, int width, int height);

/// How targets are followed from frame to frame.
struct TrackerKind {
  std::string name;
  std::shared_ptr<cv::Tracker> (*create)();  ///< null: without a tracker, by colour and depth
};

/// From what follows best to what is fastest.
const std::vector<TrackerKind>& tracker_kinds();
/// Throws usage_error with the known names.
const TrackerKind& find_tracker(const std::string& name);

/// One of OpenCV's trackers on a crop of the masked image that moves with the predicted motion: the
/// tracker itself sees a target that hardly moves, which lifts its speed limit (CSRT: about 1.5
/// target sizes a frame). Of a kind without a tracker: never finds anything.
class BoxTracker {
 public:
  explicit BoxTracker(const TrackerKind& kind);
  ~BoxTracker();
  BoxTracker(BoxTracker&&) noexcept;
  BoxTracker& operator=(BoxTracker&&) noexcept;

  void start(const MaskedImage& image, const PixelBox& box);
  /// The box in `image`, looked for around `predicted_x`, `predicted_y` (its centre). Nothing if
  /// the tracker gives up or was never started.
  std::optional<PixelBox> update(const MaskedImage& image, double predicted_x, double predicted_y);
  void stop();
  /// Times it was set on a target.
  int starts() const { return starts_; }

 private:
  struct State;
  const TrackerKind* kind_;
  int starts_ = 0;
  std::unique_ptr<State> state_;
};

}  // namespace touchtrace::label
