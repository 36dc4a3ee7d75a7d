#include "pipeline/label/observe/masked_color_observer.h"

namespace touchtrace::label {

Surface MaskedColorObserver::observe(const RgbdFrame& frame, const std::string& object) const {
  Surface surface = colors_->observe(frame, object);
  if (frame.mask.empty()) return surface;
  std::erase_if(surface, [&](const SurfacePoint& point) {
    return masks_.is_masked(frame, point) || (only_body_ && point.body == body_of(*only_body_));
  });
  const Surface masked = masks_.observe(frame, object);
  surface.insert(surface.end(), masked.begin(), masked.end());
  return surface;
}

void MaskedColorObserver::classify(const RgbdFrame& frame, const std::string& object,
                                   Surface& points) const {
  if (frame.mask.empty() || only_body_) colors_->classify(frame, object, points);
  if (frame.mask.empty()) return;
  if (!only_body_) {
    masks_.classify(frame, object, points);
    return;
  }
  const Body body = body_of(*only_body_);
  for (auto& point : points)
    if (masks_.is_masked(frame, point))
      point.body = body;
    else if (point.body == body)
      point.body = Body::rest;
}

}  // namespace touchtrace::label
