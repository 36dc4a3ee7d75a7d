#pragma once

#include <memory>
#include <optional>

#include "pipeline/label/observe/depth_color_observer.h"
#include "pipeline/label/observe/mask_observer.h"

namespace touchtrace::label {

/// Classes from colours and, for hand and object in a frame with a mask, from that. Points outside
/// the mask keep the class of their colour; classify() makes them `rest`. If the masks show one
/// body only, it is where the mask is, and colours decide between the other one and `rest`.
class MaskedColorObserver : public Observer {
 public:
  /// `segmenter`: without a background, which may contain a body that does not move. `only_body`:
  /// that the masks show.
  MaskedColorObserver(std::shared_ptr<const DepthColorObserver> colors,
                      std::shared_ptr<const Segmenter> segmenter,
                      std::optional<MaskValue> only_body)
      : colors_(std::move(colors)), masks_(std::move(segmenter)), only_body_(only_body) {}

  Surface observe(const RgbdFrame& frame, const std::string& object) const override;
  void classify(const RgbdFrame& frame, const std::string& object, Surface& points) const override;

 private:
  std::shared_ptr<const DepthColorObserver> colors_;
  MaskObserver masks_;
  std::optional<MaskValue> only_body_;
};

}  // namespace touchtrace::label
