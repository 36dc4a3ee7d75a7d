#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "calib/rgbd/calibration.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Colour class of a point; `rest`: arm, torso and anything else.
enum class Body : std::uint8_t { rest, hand, object };

/// A depth measurement with the colour at its place.
struct SurfacePoint {
  Eigen::Vector3f position_m;  ///< colour camera's frame, depth corrected by the calibration
  std::int16_t u, v;           ///< nearest pixel of the colour image
  std::array<std::uint8_t, 3> rgb;
  Body body = Body::rest;
  bool is_foreground = true;  ///< in front of the background, or the background is unknown
  /// Logarithm of the colour's frequency in its class over a usual one's; 0: not known.
  float likeness = 0.0f;
};

using Surface = std::vector<SurfacePoint>;

/// Whether the point's pixel is inside the box.
bool contains(const PixelBox& box, const SurfacePoint& point);

/// The points of one class, in order.
Surface points_of(const Surface& surface, Body body);

/// The points whose pixels are inside the box, in order.
Surface points_in(const Surface& surface, const PixelBox& box);

/// Subtracts the background from depth images. Lifts the remaining pixels to coloured points in the
/// colour camera's frame.
class Segmenter {
 public:
  /// Without a background: every measurement is in front of it.
  Segmenter(const RgbdCalibration& calibration, const CameraInfo& camera);

  /// `depth` [depth height, depth width]: counts of the empty scene; 0: unknown. Points in front of
  /// it by six standard deviations of its noise (20 mm at least), or by background_gap() if that is
  /// less, are foreground. `noise_at_1m` [m]: see depth_noise_at_1m().
  void set_background(std::vector<std::uint16_t> depth, std::optional<double> noise_at_1m);
  /// Indices of the depth pixels with a measurement whose points are inside a box of the colour
  /// image.
  std::vector<std::size_t> depth_pixels_in(const RgbdFrame& frame, const PixelBox& box) const;

  /// Points in front of the background, without speckles and without points that the colour camera
  /// cannot see. `filter` gets the points of one image row; it may change and erase them.
  Surface foreground_surface(
      const RgbdFrame& frame, const std::function<void(Surface&)>& filter = [](Surface&) {}) const;
  /// All points, background included (is_foreground), whose depth pixels are within `radius_m` of
  /// the projection of `centre_m` along each image axis. Occluded points are kept.
  Surface surface_around(const RgbdFrame& frame, const Eigen::Vector3d& centre_m,
                         double radius_m) const;
  /// Area of a disc of `radius_m` facing the camera at `depth_m`, in depth pixels.
  double disc_pixels(double radius_m, double depth_m) const {
    return M_PI * radius_m * radius_m / (depth_m * depth_m) * depth_.fx * depth_.fy;
  }
  /// Whether the colour camera sees a position.
  bool is_in_image(const Eigen::Vector3d& position_m) const;
  /// Width of a depth pixel as an angle [rad].
  double pixel_angular_size_rad() const { return 1.0 / depth_.fx; }
  /// Optical centre of the depth camera in the colour camera's frame.
  Eigen::Vector3d depth_origin_m() const { return depth_origin_m_.cast<double>(); }
  const Camera& color_camera() const { return color_; }
  /// Index of a point's pixel in the colour image.
  std::size_t color_pixel(const SurfacePoint& point) const {
    return static_cast<std::size_t>(point.v * width_ + point.u);
  }
  /// Depth [counts] by which a point is certainly in front of the background at `background`
  /// counts, whatever the noise.
  double background_gap(double background) const;

 private:
  bool is_foreground(const RgbdFrame& frame, std::size_t pixel) const {
    return limit_[pixel] == 0 || frame.depth[pixel] < limit_[pixel];
  }
  /// Appends the points of depth pixels that project into the colour image.
  void lift(const RgbdFrame& frame, std::span<const std::size_t> pixels, Surface& to) const;
  /// Whether the nearest pixel belongs to the colour image.
  bool has_color(const Eigen::Vector2d& pixel) const {
    return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < width_ - 0.5 &&
           pixel.y() < height_ - 0.5;
  }
  SurfacePoint colored(const RgbdFrame& frame, const Eigen::Vector3f& position_m,
                       const Eigen::Vector2d& pixel) const;
  double corrected_depth_m(std::uint16_t count) const {
    return depth_offset_m_ + depth_scale_ * count;
  }

  Camera color_, depth_;
  Eigen::Isometry3d depth_from_color_;
  int width_, height_;              ///< of the colour image
  int depth_width_, depth_height_;  ///< of the depth image
  double depth_unit_m_;
  double depth_scale_, depth_offset_m_;  ///< depth [m] = offset + scale * count
  Eigen::Vector3f depth_origin_m_;       ///< see depth_origin_m()
  std::vector<Eigen::Vector3f> rays_;    ///< of depth pixels, depth 1, colour camera's axes
  std::vector<std::uint16_t> limit_;     ///< counts from it on are background; 0: no limit
};

}  // namespace touchtrace::label
