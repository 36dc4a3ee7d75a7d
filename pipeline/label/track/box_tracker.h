#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/label/observe/surface.h"

namespace cv {
class Tracker;
}

namespace touchtrace::label {

/// Colour image of the foreground points, black elsewhere.
struct MaskedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height, width, 3]
};

MaskedImage masked_image(const RgbdFrame& frame, const Surface& surface, int width, int height);

/// Image tracker by its name for `--tracker`.
struct TrackerKind {
  std::string name;
  std::shared_ptr<cv::Tracker> (*create)();  ///< null: colour and depth only
};

/// All kinds.
const std::vector<TrackerKind>& tracker_kinds();
/// Throws usage_error, with the known names, for an unknown one.
const TrackerKind& find_tracker(const std::string& name);

/// An OpenCV tracker on a crop of the masked image that moves with the predicted motion. The
/// tracker sees a nearly static target, which lifts its speed limit (CSRT: about 1.5 target sizes
/// per frame). A kind without a tracker never finds anything.
class BoxTracker {
 public:
  explicit BoxTracker(const TrackerKind& kind);
  ~BoxTracker();
  BoxTracker(BoxTracker&&) noexcept;
  BoxTracker& operator=(BoxTracker&&) noexcept;

  void start(const MaskedImage& image, const PixelBox& box);
  /// Searches around the predicted centre [px]. Returns nullopt if the tracker gives up or was not
  /// started.
  std::optional<PixelBox> update(const MaskedImage& image, double predicted_x, double predicted_y);
  void stop();
  /// Number of starts so far.
  int starts() const { return starts_; }

 private:
  struct State;
  const TrackerKind* kind_;
  int starts_ = 0;
  std::unique_ptr<State> state_;
};

}  // namespace touchtrace::label
