#pragma once

#include <array>
#include <vector>

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// Tells hand, object and the rest (arm, torso) apart by colour: chromaticity, and brightness
/// coarsely, so that a material's shades stay together. Learnt from frames in which boxes were
/// drawn. The object's box mostly holds fingers too, so a colour is the object's only if it is
/// several times as frequent there as anywhere else.
class ColorClasses {
 public:
  /// Counts one frame's colours.
  void learn(const Surface& surface, const PixelBox& hand_box, const PixelBox& object_box);
  /// Of an object that its boxes did not show: takes what was near the hand at other times for
  /// them. Hand and arm are more frequent elsewhere, so that what is left is the object.
  void learn_object_from(const Surface& near_hand);
  /// To be called once all frames are learnt, and again after learning more.
  void settle();

  Body of(const std::array<std::uint8_t, 3>& rgb) const { return table_[bin(rgb)]; }
  void assign(Surface& surface) const;

 private:
  static constexpr std::size_t chroma_levels = 32, brightness_levels = 4;
  static constexpr std::size_t bins = chroma_levels * chroma_levels * brightness_levels;

  struct Levels;

  static std::size_t bin(const std::array<std::uint8_t, 3>& rgb);
  static std::vector<double> density(const std::vector<double>& counts);

  std::array<std::vector<double>, 3> counts_{std::vector<double>(bins), std::vector<double>(bins),
                                             std::vector<double>(bins)};  ///< by Body
  std::vector<Body> table_ = std::vector<Body>(bins, Body::rest);
};

}  // namespace touchtrace::label
