#pragma once

#include <array>
#include <vector>

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// Tells hand, object and the rest (arm, torso) apart by colour. Learnt from frames in which boxes
/// were drawn: the object's box may hold fingers and the hand's box the object, so a colour belongs
/// to the body in whose box it is relatively most frequent.
class ColorClasses {
 public:
  /// Counts one frame's colours.
  void learn(const Surface& surface, const PixelBox& hand_box, const PixelBox& object_box);
  /// To be called once all frames are learnt.
  void settle();

  Body of(const std::array<std::uint8_t, 3>& rgb) const { return table_[bin(rgb)]; }
  void assign(Surface& surface) const;

 private:
  static constexpr std::size_t levels =
      16;  // of each channel: coarse enough to learn from few frames

  static std::size_t bin(const std::array<std::uint8_t, 3>& rgb) {
    return (static_cast<std::size_t>(rgb[0] >> 4) * levels + (rgb[1] >> 4)) * levels +
           (rgb[2] >> 4);
  }

  std::array<std::vector<double>, 3> counts_{std::vector<double>(levels * levels * levels),
                                             std::vector<double>(levels* levels* levels),
                                             std::vector<double>(levels* levels* levels)};
  std::vector<Body> table_ = std::vector<Body>(levels * levels * levels, Body::rest);
};

}  // namespace touchtrace::label
