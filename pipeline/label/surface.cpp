#include "pipeline/label/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr double background_gap_m = 0.06, background_gap_part = 0.04;
constexpr float occlusion_m =
    0.05f;  // a point so far behind another of the same pixel is not seen there

}  // namespace

bool contains(const PixelBox& box, const SurfacePoint& point) {
  return point.u >= box.x && point.u < box.x + box.width && point.v >= box.y &&
         point.v < box.y + box.height;
}

std::vector<std::uint16_t> median_depth(const std::vector<std::vector<std::uint16_t>>& depths) {
  std::vector<std::uint16_t> result(depths.empty() ? 0 : depths.front().size());
  std::vector<std::uint16_t> seen;
  for (std::size_t pixel = 0; pixel < result.size(); ++pixel) {
    seen.clear();
    for (const auto& depth : depths)
      if (depth[pixel] > 0) seen.push_back(depth[pixel]);
    if (seen.empty()) continue;
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    result[pixel] = *middle;
  }
  return result;
}

Segmenter::Segmenter(const RgbdCalibration& calibration, const CameraInfo& camera,
                     std::vector<std::uint16_t> background_depth)
    : color_(calibration.color),
      depth_(calibration.depth ? *calibration.depth : calibration.color),
      depth_from_color_(calibration.depth_from_color),
      width_(camera.width),
      height_(camera.height),
      depth_scale_(calibration.depth_scale * camera.depth_unit_m),
      depth_offset_m_(calibration.depth_offset_m),
      limit_(std::move(background_depth)) {
  const Eigen::Isometry3d color_from_depth = depth_from_color_.inverse();
  depth_origin_m_ = color_from_depth.translation().cast<float>();
  rays_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int v = 0; v < height_; ++v)
    for (int u = 0; u < width_; ++u)
      rays_.push_back((color_from_depth.linear() * depth_.unproject({u, v})).cast<float>());
  for (auto& limit : limit_) {
    const double gap_m =
        std::max(background_gap_m, background_gap_part * limit * camera.depth_unit_m);
    limit = static_cast<std::uint16_t>(std::max(0.0, limit - gap_m / camera.depth_unit_m));
  }
}

std::vector<std::uint8_t> Segmenter::mask(const RgbdFrame& frame) const {
  std::vector<std::uint8_t> raw(frame.depth.size()), clean(frame.depth.size(), 0);
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = frame.depth[i] > 0 && (limit_.empty() || limit_[i] == 0 || frame.depth[i] < limit_[i]);
  const auto w = static_cast<std::size_t>(width_);
  for (std::size_t v = 1; v + 1 < static_cast<std::size_t>(height_); ++v)
    for (std::size_t u = 1; u + 1 < w; ++u) {
      const std::uint8_t* p = &raw[v * w + u];
      const int neighbours =
          p[-1] + p[1] + p[w] + p[w - 1] + p[w + 1] + *(p - w) + *(p - w - 1) + *(p - w + 1);
      clean[v * w + u] = p[0] != 0 && neighbours >= 4;
    }
  return clean;
}

std::optional<SurfacePoint> Segmenter::lift(const RgbdFrame& frame, std::size_t pixel) const {
  const Eigen::Vector3f point =
      depth_origin_m_ + static_cast<float>(corrected_depth_m(frame.depth[pixel])) * rays_[pixel];
  if (!(point.z() > 0.05f)) return std::nullopt;
  const Eigen::Vector2d seen = color_.project(point.cast<double>());
  const auto u = std::lround(seen.x()), v = std::lround(seen.y());
  if (u < 0 || v < 0 || u >= width_ || v >= height_) return std::nullopt;
  const auto at = static_cast<std::size_t>(v * width_ + u);
  return SurfacePoint{point,
                      static_cast<std::int16_t>(u),
                      static_cast<std::int16_t>(v),
                      {frame.color[3 * at], frame.color[3 * at + 1], frame.color[3 * at + 2]}};
}

Surface Segmenter::moving_surface(const RgbdFrame& frame) const {
  const auto foreground = mask(frame);
  Surface surface;
  std::vector<float> nearest(rays_.size(), std::numeric_limits<float>::infinity());
  const auto at = [&](const SurfacePoint& point) {
    return static_cast<std::size_t>(point.v * width_ + point.u);
  };
  for (std::size_t i = 0; i < foreground.size(); ++i) {
    if (foreground[i] == 0) continue;
    const auto point = lift(frame, i);
    if (!point) continue;
    nearest[at(*point)] = std::min(nearest[at(*point)], point->position_m.z());
    surface.push_back(*point);
  }
  std::erase_if(surface, [&](const SurfacePoint& point) {
    return point.position_m.z() > nearest[at(point)] + occlusion_m;
  });
  return surface;
}

bool Segmenter::in_picture(const Eigen::Vector3d& position_m) const {
  if (!(position_m.z() > 0.0)) return false;
  const Eigen::Vector2d pixel = color_.project(position_m);
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < width_ && pixel.y() < height_;
}

Surface Segmenter::surface_around(const RgbdFrame& frame, const Eigen::Vector3d& center_m,
                                  double radius_m) const {
  const Eigen::Vector3d center = depth_from_color_ * center_m;
  const Eigen::Vector2d middle = depth_.project(center);
  if (!middle.allFinite()) return {};
  const double half = radius_m / center.z() * depth_.fx;
  Surface surface;
  const auto from = [](double edge) { return std::max(0, static_cast<int>(edge)); };
  const int right = std::min(width_, static_cast<int>(middle.x() + half) + 1);
  const int bottom = std::min(height_, static_cast<int>(middle.y() + half) + 1);
  for (int v = from(middle.y() - half); v < bottom; ++v)
    for (int u = from(middle.x() - half); u < right; ++u) {
      const auto pixel = static_cast<std::size_t>(v * width_ + u);
      if (frame.depth[pixel] == 0) continue;
      if (const auto point = lift(frame, pixel)) surface.push_back(*point);
    }
  return surface;
}

}  // namespace touchtrace::label
