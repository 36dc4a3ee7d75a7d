#pragma once

#include <memory>

#include "pipeline/label/observe/observer.h"

namespace touchtrace::label {

/// Class of a mask's value.
Body body_of(std::uint8_t value);

/// Classes from the recording's instance masks. A frame without a mask shows neither hand nor
/// object.
class MaskObserver : public Observer {
 public:
  explicit MaskObserver(std::shared_ptr<const Segmenter> segmenter)
      : segmenter_(std::move(segmenter)) {}

  Surface observe(const RgbdFrame& frame, const std::string& object) const override;
  void classify(const RgbdFrame& frame, const std::string& object, Surface& points) const override;
  /// Whether the mask of a frame that has one shows hand or object at a point.
  bool is_masked(const RgbdFrame& frame, const SurfacePoint& point) const;

 private:
  std::shared_ptr<const Segmenter> segmenter_;
};

/// Smallest box around the pixels of `value`; empty if there are none.
PixelBox mask_box(const RgbdFrame& frame, MaskValue value, int width);

}  // namespace touchtrace::label
