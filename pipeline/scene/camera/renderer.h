#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "engine/cl/runtime.h"
#include "pipeline/scene/camera/camera_model.h"

namespace touchtrace::scene {

enum class Pattern { plain, cloth, chessboard };

/// A solid in the world with its surface pattern.
struct PaintedSolid {
  Solid solid;
  Pattern pattern = Pattern::plain;
  /// cloth: contrast, waves per metre; chessboard: square [m], columns, rows of squares
  std::array<double, 3> pattern_values{};
};

/// The scene during one exposure.
struct Exposure {
  /// Solids at the middles of equal parts of the colour exposure; same number and order in each.
  std::vector<std::vector<PaintedSolid>> color;
  std::vector<PaintedSolid> depth;  ///< at the middle of the exposure
};

/// Exposure of a static scene.
inline Exposure static_exposure(const std::vector<PaintedSolid>& solids) {
  return {{solids}, solids};
}

/// Ray caster for one camera on an OpenCL device. A frame depends only on the arguments of
/// render(), not on earlier frames. Not thread-safe; the Runtime must outlive it.
class Renderer {
 public:
  /// Throws usage_error unless the image width is a multiple of 16.
  Renderer(Runtime& runtime, const RgbdCamera& camera, std::uint64_t seed);
  ~Renderer();

  /// `stream` and `number` select the frame's noise. Casts `samples_per_axis`^2 rays per colour
  /// pixel. Blocks until the frame is downloaded.
  RgbdFrame render(const Exposure& exposure, std::string_view stream, std::uint64_t number,
                   int samples_per_axis = 2);

 private:
  struct Device;
  RgbdCamera camera_;
  std::uint64_t seed_;
  std::unique_ptr<Device> device_;
};

}  // namespace touchtrace::scene
