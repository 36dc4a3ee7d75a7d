#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "engine/cl/runtime.h"
#include "pipeline/scene/camera/camera_model.h"

namespace touchtrace::scene {

enum class Pattern { plain, cloth, chessboard };

/// A solid in the world with what is on its surface.
struct PaintedSolid {
  Solid solid;
  Pattern pattern = Pattern::plain;
  /// cloth: contrast, waves per metre; chessboard: square [m], columns, rows of squares
  std::array<double, 3> pattern_values{};
};

/// What is before the camera during one exposure.
struct Exposure {
  /// The solids at the middles of equal parts of the colour exposure, as many and in the same order
  /// each time.
  std::vector<std::vector<PaintedSolid>> color;
  std::vector<PaintedSolid> depth;  ///< at the middle of the exposure
};

/// An exposure of what does not move.
inline Exposure still(const std::vector<PaintedSolid>& solids) { return {{solids}, solids}; }

/// Renders frames of one camera on an OpenCL device. Every frame depends on its arguments alone.
class Renderer {
 public:
  /// The image's width must be a multiple of 16.
  Renderer(Runtime& runtime, const RgbdCamera& camera, std::uint64_t seed);
  ~Renderer();

  /// `stream` and `number` name the frame's noise. `samples_per_axis`^2 rays are cast a colour
  /// pixel.
  RgbdFrame render(const Exposure& exposure, std::string_view stream, std::uint64_t number,
                   int samples_per_axis = 2);

 private:
  struct Device;
  RgbdCamera camera_;
  std::uint64_t seed_;
  std::unique_ptr<Device> device_;
};

}  // namespace touchtrace::scene
