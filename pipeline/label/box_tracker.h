#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// The colour image where the moving surface is, black elsewhere.
struct MaskedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height, width, 3]
};

MaskedImage masked_image(const RgbdFrame& frame, const Surface& surface, int width, int height);

/// OpenCV's CSRT on a crop of the masked image that moves with the predicted motion: the tracker
/// itself sees a target that hardly moves, which lifts its speed limit of about 1.5 target sizes a
/// frame.
class BoxTracker {
 public:
  BoxTracker();
  ~BoxTracker();
  BoxTracker(BoxTracker&&) noexcept;
  BoxTracker& operator=(BoxTracker&&) noexcept;

  void start(const MaskedImage& image, const PixelBox& box);
  /// The box in `image`, looked for around `predicted_x`, `predicted_y` (its centre). Nothing if
  /// the tracker gives up or was never started.
  std::optional<PixelBox> update(const MaskedImage& image, double predicted_x, double predicted_y);
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchtrace::label
