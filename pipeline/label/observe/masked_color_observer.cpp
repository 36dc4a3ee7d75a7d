#include "pipeline/label/observe/masked_color_observer.h"

namespace touchtrace::label {

Surface MaskedColorObserver::observe(const RgbdFrame& frame, const std::string& object) const {
  Surface surface = colors_->observe(frame, object);
  if (frame.mask.empty()) return surface;
  std::erase_if(surface, [&](const SurfacePoint& point) { return masks_.is_masked(frame, point); });
  const Surface masked = masks_.observe(frame, object);
  surface.insert(surface.end(), masked.begin(), masked.end());
  return surface;
}

void MaskedColorObserver::classify(const RgbdFrame& frame, const std::string& object,
                                   Surface& points) const {
  if (frame.mask.empty())
    colors_->classify(frame, object, points);
  else
    masks_.classify(frame, object, points);
}

}  // namespace touchtrace::label
