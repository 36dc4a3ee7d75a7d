#include "pipeline/label/observe/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/label/observe/foreground.h"

namespace touchtrace::label {
namespace {

constexpr double background_gap_m = 0.06, background_gap_fraction = 0.04;  // the larger of the two
constexpr double min_gap_m = 0.02, gap_sigmas = 6.0;
// A point so far behind another one of the same colour pixel is occluded in the colour image.
constexpr float occlusion_m = 0.05f;
constexpr float min_depth_m = 0.05f;

}  // namespace

bool contains(const PixelBox& box, const SurfacePoint& point) {
  return point.u >= box.x && point.u < box.x + box.width && point.v >= box.y &&
         point.v < box.y + box.height;
}

Surface points_of(const Surface& surface, Body body) {
  Surface result;
  std::ranges::copy_if(surface, std::back_inserter(result),
                       [&](const SurfacePoint& point) { return point.body == body; });
  return result;
}

Surface points_in(const Surface& surface, const PixelBox& box) {
  Surface result;
  std::ranges::copy_if(surface, std::back_inserter(result),
                       [&](const SurfacePoint& point) { return contains(box, point); });
  return result;
}

Segmenter::Segmenter(const RgbdCalibration& calibration, const CameraInfo& camera)
    : color_(calibration.color),
      depth_(calibration.depth ? *calibration.depth : calibration.color),
      depth_from_color_(calibration.depth_from_color),
      width_(camera.width),
      height_(camera.height),
      depth_width_(camera.depth_image_width()),
      depth_height_(camera.depth_image_height()),
      depth_unit_m_(camera.depth_unit_m),
      depth_scale_(calibration.depth_scale * camera.depth_unit_m),
      depth_offset_m_(calibration.depth_offset_m) {
  const Eigen::Isometry3d color_from_depth = depth_from_color_.inverse();
  depth_origin_m_ = color_from_depth.translation().cast<float>();
  rays_.reserve(static_cast<std::size_t>(depth_width_) * static_cast<std::size_t>(depth_height_));
  for (int v = 0; v < depth_height_; ++v)
    for (int u = 0; u < depth_width_; ++u)
      rays_.push_back((color_from_depth.linear() * depth_.unproject({u, v})).cast<float>());
  limit_.resize(rays_.size());
}

double Segmenter::background_gap(double background) const {
  return std::max(background_gap_m / depth_unit_m_, background_gap_fraction * background);
}

void Segmenter::set_background(std::vector<std::uint16_t> depth,
                               std::optional<double> noise_at_1m) {
  limit_ = std::move(depth);
  limit_.resize(rays_.size());
  for (auto& limit : limit_) {
    const double noise_m = noise_at_1m ? *noise_at_1m * std::pow(depth_unit_m_ * limit, 2)
                                       : std::numeric_limits<double>::infinity();
    const double gap =
        std::min(background_gap(limit), std::max(min_gap_m, gap_sigmas * noise_m) / depth_unit_m_);
    limit = static_cast<std::uint16_t>(std::max(0.0, limit - gap));
  }
}

std::vector<std::size_t> Segmenter::depth_pixels_in(const RgbdFrame& frame,
                                                    const PixelBox& box) const {
  std::vector<std::size_t> pixels;
  Surface point;
  for (std::size_t pixel = 0; pixel < rays_.size(); ++pixel) {
    if (frame.depth[pixel] == 0) continue;
    point.clear();
    lift(frame, {&pixel, 1}, point);
    if (!point.empty() && contains(box, point.front())) pixels.push_back(pixel);
  }
  return pixels;
}

void Segmenter::lift(const RgbdFrame& frame, std::span<const std::size_t> pixels,
                     Surface& to) const {
  constexpr std::size_t block = 64;
  std::array<Eigen::Vector3f, block> points;
  std::array<Eigen::Vector2d, block> projected;
  std::array<std::size_t, block> depth_pixels;
  for (; !pixels.empty(); pixels = pixels.subspan(std::min(block, pixels.size()))) {
    std::size_t count = 0;
    for (const auto pixel : pixels.first(std::min(block, pixels.size()))) {
      points[count] = depth_origin_m_ +
                      static_cast<float>(corrected_depth_m(frame.depth[pixel])) * rays_[pixel];
      depth_pixels[count] = pixel;
      count += points[count].z() > min_depth_m;
    }
    color_.project(std::span(points).first(count), std::span(projected).first(count));
    for (std::size_t i = 0; i < count; ++i)
      if (has_color(projected[i])) {
        to.push_back(colored(frame, points[i], projected[i]));
        to.back().is_foreground = is_foreground(frame, depth_pixels[i]);
      }
  }
}

SurfacePoint Segmenter::colored(const RgbdFrame& frame, const Eigen::Vector3f& position_m,
                                const Eigen::Vector2d& pixel) const {
  const auto nearest = [](double coordinate) {
    return static_cast<std::int16_t>(coordinate + 0.5);
  };
  SurfacePoint point{position_m, nearest(pixel.x()), nearest(pixel.y()), {}};
  std::copy_n(&frame.color[3 * color_pixel(point)], 3, point.rgb.begin());
  return point;
}

Surface Segmenter::foreground_surface(const RgbdFrame& frame,
                                      const std::function<void(Surface&)>& filter) const {
  // Reused: new pages for every image would double the time.
  thread_local std::vector<float> nearest;
  nearest.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                 std::numeric_limits<float>::infinity());
  Foreground foreground(frame.depth, limit_, depth_width_);
  Surface surface, row;
  for (std::size_t v = 1; v + 1 < static_cast<std::size_t>(depth_height_); ++v) {
    row.clear();
    lift(frame, foreground.row(v), row);
    for (const auto& point : row) {
      float& depth = nearest[color_pixel(point)];
      depth = std::min(depth, point.position_m.z());
    }
    filter(row);
    surface.insert(surface.end(), row.begin(), row.end());
  }
  std::erase_if(surface, [&](const SurfacePoint& point) {
    return point.position_m.z() > nearest[color_pixel(point)] + occlusion_m;
  });
  return surface;
}

bool Segmenter::is_in_image(const Eigen::Vector3d& position_m) const {
  if (!(position_m.z() > 0.0)) return false;
  const Eigen::Vector2d pixel = color_.project(position_m);
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < width_ && pixel.y() < height_;
}

Surface Segmenter::surface_around(const RgbdFrame& frame, const Eigen::Vector3d& centre_m,
                                  double radius_m) const {
  const Eigen::Vector3d centre = depth_from_color_ * centre_m;
  const Eigen::Vector2d projected = depth_.project(centre);
  if (!projected.allFinite()) return {};
  const double half = radius_m / centre.z() * depth_.fx;
  Surface surface;
  std::vector<std::size_t> measured;
  const auto from = [](double edge) { return std::max(0, static_cast<int>(edge)); };
  const int right = std::min(depth_width_, static_cast<int>(projected.x() + half) + 1);
  const int bottom = std::min(depth_height_, static_cast<int>(projected.y() + half) + 1);
  for (int v = from(projected.y() - half); v < bottom; ++v)
    for (int u = from(projected.x() - half); u < right; ++u) {
      const auto pixel = static_cast<std::size_t>(v * depth_width_ + u);
      if (frame.depth[pixel] > 0) measured.push_back(pixel);
    }
  lift(frame, measured, surface);
  return surface;
}

}  // namespace touchtrace::label
