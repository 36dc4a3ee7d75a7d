#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
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

/// Finds what stands before the background, in the depth camera's image, and gives each point its
/// place in the colour camera's frame and its colour.
class Segmenter {
 public:
  Segmenter(const RgbdCalibration& calibration, const CameraInfo& camera,
            std::vector<std::uint16_t> background_depth);

  Surface moving_surface(const RgbdFrame& frame) const;
  /// Everything measured by the pixels that look within `radius_m` of `center_m`, the background
  /// too; nothing is left out that stands behind something else.
  Surface surface_around(const RgbdFrame& frame, const Eigen::Vector3d& center_m,
                         double radius_m) const;
  /// How many depth pixels see a disc of `radius_m` at `depth_m`.
  double disc_pixels(double radius_m, double depth_m) const {
    return M_PI * radius_m * radius_m / (depth_m * depth_m) * depth_.fx * depth_.fy;
  }
  bool in_picture(const Eigen::Vector3d& position_m) const;
  /// Where the depth camera stands.
  Eigen::Vector3d depth_eye_m() const { return depth_origin_m_.cast<double>(); }
  const Camera& color_camera() const { return color_; }

 private:
  std::vector<std::uint8_t> mask(const RgbdFrame& frame) const;
  /// What a depth pixel measured, or nothing if the colour camera does not look there.
  std::optional<SurfacePoint> lift(const RgbdFrame& frame, std::size_t pixel) const;
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
