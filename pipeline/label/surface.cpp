#include "pipeline/label/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pipeline/label/foreground.h"

namespace touchtrace::label {
namespace {

// A foreground point is nearer than the background by the larger of the two.
constexpr double background_gap_m = 0.06, background_gap_fraction = 0.04;
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

std::vector<std::uint16_t> median_depth(const std::vector<std::vector<std::uint16_t>>& depths) {
  std::vector<std::uint16_t> result(depths.empty() ? 0 : depths.front().size());
  std::vector<std::uint16_t> measured;
  for (std::size_t pixel = 0; pixel < result.size(); ++pixel) {
    measured.clear();
    for (const auto& depth : depths)
      if (depth[pixel] > 0) measured.push_back(depth[pixel]);
    if (measured.empty()) continue;
    const auto median = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
    std::nth_element(measured.begin(), median, measured.end());
    result[pixel] = *median;
  }
  return result;
}

double depth_noise_at_1m(const std::vector<std::vector<std::uint16_t>>& depths, double unit_m) {
  constexpr std::size_t stride = 7, min_images = 3;
  constexpr double static_fraction = 0.9;
  std::vector<double> squares;
  for (std::size_t pixel = 0; depths.size() >= min_images && pixel < depths[0].size();
       pixel += stride) {
    double count = 0.0, sum = 0.0, square_sum = 0.0;
    for (const auto& depth : depths)
      if (const double z = unit_m * depth[pixel]; z > 0.0)
        count += 1.0, sum += z, square_sum += z * z;
    if (count < min_images) continue;
    const double mean = sum / count, variance = (square_sum - sum * mean) / (count - 1.0);
    squares.push_back(variance / std::pow(mean, 4));
  }
  std::ranges::sort(squares);
  squares.resize(static_cast<std::size_t>(static_fraction * static_cast<double>(squares.size())));
  return squares.empty() ? 0.0
                         : std::sqrt(std::max(0.0, std::reduce(squares.begin(), squares.end()) /
                                                       static_cast<double>(squares.size())));
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
  limit_.resize(rays_.size());
  for (auto& limit : limit_) {
    const double gap_m =
        std::max(background_gap_m, background_gap_fraction * limit * camera.depth_unit_m);
    limit = static_cast<std::uint16_t>(std::max(0.0, limit - gap_m / camera.depth_unit_m));
  }
}

void Segmenter::lift(const RgbdFrame& frame, std::span<const std::size_t> pixels,
                     Surface& to) const {
  constexpr std::size_t block = 64;
  std::array<Eigen::Vector3f, block> points;
  std::array<Eigen::Vector2d, block> projected;
  for (; !pixels.empty(); pixels = pixels.subspan(std::min(block, pixels.size()))) {
    std::size_t count = 0;
    for (const auto pixel : pixels.first(std::min(block, pixels.size()))) {
      points[count] = depth_origin_m_ +
                      static_cast<float>(corrected_depth_m(frame.depth[pixel])) * rays_[pixel];
      count += points[count].z() > min_depth_m;
    }
    color_.project(std::span(points).first(count), std::span(projected).first(count));
    for (std::size_t i = 0; i < count; ++i)
      if (has_color(projected[i])) to.push_back(colored(frame, points[i], projected[i]));
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
  nearest.assign(rays_.size(), std::numeric_limits<float>::infinity());
  Foreground foreground(frame.depth, limit_, width_);
  Surface surface, row;
  for (std::size_t v = 1; v + 1 < static_cast<std::size_t>(height_); ++v) {
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
  const int right = std::min(width_, static_cast<int>(projected.x() + half) + 1);
  const int bottom = std::min(height_, static_cast<int>(projected.y() + half) + 1);
  for (int v = from(projected.y() - half); v < bottom; ++v)
    for (int u = from(projected.x() - half); u < right; ++u) {
      const auto pixel = static_cast<std::size_t>(v * width_ + u);
      if (frame.depth[pixel] > 0) measured.push_back(pixel);
    }
  lift(frame, measured, surface);
  return surface;
}

}  // namespace touchtrace::label
