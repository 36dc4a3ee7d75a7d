#include "pipeline/label/observe/mask_observer.h"

#include <algorithm>

namespace touchtrace::label {

Body body_of(std::uint8_t value) {
  if (value == mask_hand) return Body::hand;
  return value == mask_object ? Body::object : Body::rest;
}

void MaskObserver::classify(const RgbdFrame& frame, const std::string&, Surface& points) const {
  for (auto& point : points)
    point.body =
        frame.mask.empty() ? Body::rest : body_of(frame.mask[segmenter_->color_pixel(point)]);
}

bool MaskObserver::is_masked(const RgbdFrame& frame, const SurfacePoint& point) const {
  return body_of(frame.mask[segmenter_->color_pixel(point)]) != Body::rest;
}

Surface MaskObserver::observe(const RgbdFrame& frame, const std::string& object) const {
  if (frame.mask.empty()) return {};
  return segmenter_->foreground_surface(frame, [&](Surface& points) {
    classify(frame, object, points);
    std::erase_if(points, [](const SurfacePoint& point) { return point.body == Body::rest; });
  });
}

PixelBox mask_box(const RgbdFrame& frame, MaskValue value, int width) {
  int left = width, right = -1, top = 0, bottom = -1;
  for (std::size_t i = 0; i < frame.mask.size(); ++i) {
    if (frame.mask[i] != value) continue;
    const int u = static_cast<int>(i) % width, v = static_cast<int>(i) / width;
    if (bottom < 0) top = v;
    left = std::min(left, u), right = std::max(right, u), bottom = v;
  }
  return bottom < 0 ? PixelBox{} : PixelBox{left, top, right - left + 1, bottom - top + 1};
}

}  // namespace touchtrace::label
