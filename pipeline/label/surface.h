#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "calib/rgbd/calibration.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

enum class Body : std::uint8_t { rest, hand, object };

/// A measured point of a moving surface.
struct SurfacePoint {
  Eigen::Vector3f position_m;  ///< colour camera's frame, depth corrected by the calibration
  std::int16_t u, v;           ///< pixel of the colour image
  std::array<std::uint8_t, 3> rgb;
  Body body = Body::rest;
};

using Surface = std::vector<SurfacePoint>;

bool contains(const PixelBox& box, const SurfacePoint& point);

/// The per-pixel median of depth images, holes left out; 0 where nothing was ever measured.
std::vector<std::uint16_t> median_depth(const std::vector<std::vector<std::uint16_t>>& depths);

/// Noise of a depth of 1 m [m] that grows as depth squared, as triangulation's does: how much the
/// pixels of depth images of a still scene scatter, the tenth that scatters most left out, which
/// makes it some 5 % too small. 0 of fewer than three images.
double depth_noise_at_1m(const std::vector<std::vector<std::uint16_t>>& depths, double unit_m);

/// Finds what stands before the background, in the depth camera's image, and gives each point its
/// place in the colour camera's frame and its colour.
class Segmenter {
 public:
  Segmenter(const RgbdCalibration& calibration, const CameraInfo& camera,
            std::vector<std::uint16_t> background_depth);

  /// `sift` may change and take out points; it gets them row by row.
  Surface moving_surface(
      const RgbdFrame& frame, const std::function<void(Surface&)>& sift = [](Surface&) {}) const;
  /// Everything measured by the pixels that look within `radius_m` of `center_m`, the background
  /// too; nothing is left out that stands behind something else.
  Surface surface_around(const RgbdFrame& frame, const Eigen::Vector3d& center_m,
                         double radius_m) const;
  /// How many depth pixels see a disc of `radius_m` at `depth_m`.
  double disc_pixels(double radius_m, double depth_m) const {
    return M_PI * radius_m * radius_m / (depth_m * depth_m) * depth_.fx * depth_.fy;
  }
  bool in_picture(const Eigen::Vector3d& position_m) const;
  /// A depth pixel's width over its distance.
  double pixel_rad() const { return 1.0 / depth_.fx; }
  /// Where the depth camera stands.
  Eigen::Vector3d depth_eye_m() const { return depth_origin_m_.cast<double>(); }
  const Camera& color_camera() const { return color_; }

 private:
  /// Appends what the pixels of a depth image measured where the colour camera looks.
  void lift(const RgbdFrame& frame, std::span<const std::size_t> pixels, Surface& to) const;
  /// Whether the nearest pixel is one of the colour image's.
  bool is_in_picture(const Eigen::Vector2d& seen) const {
    return seen.x() > -0.5 && seen.y() > -0.5 && seen.x() < width_ - 0.5 &&
           seen.y() < height_ - 0.5;
  }
  SurfacePoint colored(const RgbdFrame& frame, const Eigen::Vector3f& position_m,
                       const Eigen::Vector2d& seen) const;
  std::size_t color_pixel(const SurfacePoint& point) const {
    return static_cast<std::size_t>(point.v * width_ + point.u);
  }
  double corrected_depth_m(std::uint16_t count) const {
    return depth_offset_m_ + depth_scale_ * count;
  }

  Camera color_, depth_;
  Eigen::Isometry3d depth_from_color_;
  int width_, height_;
  double depth_scale_, depth_offset_m_;  ///< metres = offset + scale * count
  Eigen::Vector3f depth_origin_m_;       ///< of the depth camera, in the colour camera's frame
  std::vector<Eigen::Vector3f>
      rays_;                          ///< of the depth pixels, rotated to the colour camera's frame
  std::vector<std::uint16_t> limit_;  ///< counts at and beyond it are background; 0: no limit
};

}  // namespace touchtrace::label
