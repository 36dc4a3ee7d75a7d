#pragma once

#include <array>
#include <vector>

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Classifies colours as hand, object or rest (arm, torso) by histograms of chromaticity and, in
/// coarse bins, brightness, so that the shades of one material share bins. Learnt from frames with
/// boxes. The object's box usually contains fingers, so a colour is the object's only if it is
/// three times as frequent in the object's box as anywhere else. The rest within an arm's reach of
/// the hand and the rest farther away are two histograms, and a colour counts as often as in the
/// one in which it is more frequent: a large room would otherwise make the sleeve's colour rare.
class ColorClasses {
 public:
  /// Adds one frame's colours to the histograms. Points in both boxes are the object's. If
  /// `is_hand_inside`, where the object's boxes contain the hand's (a bar through the fist), they
  /// are so only if their colour is three times as frequent in the rest of the object's box as
  /// outside both, and there at least a third as frequent as in both.
  void learn(const Surface& surface, const PixelBox& hand_box, const PixelBox& object_box,
             bool is_hand_inside);
  /// Replaces the object's histogram by points near the hand at other times, for an object that its
  /// boxes do not show. Colours of hand and arm are more frequent elsewhere, so what remains is the
  /// object's.
  void learn_object_from(const Surface& near_hand);
  /// Adds points of the hand in other frames to its histogram.
  void learn_hand_from(const Surface& on_hand);
  /// Whether colours of the rest are the object's, too, if they are twice as frequent in its box as
  /// in the hand's. Then colours alone do not separate the object from a sleeve: see
  /// remove_large_components().
  void let_object_share_rest(bool shares) { shares_rest_ = shares; }
  /// Builds the lookup table. Call after learning and before classifying.
  void build_table();

  Body classify(const std::array<std::uint8_t, 3>& rgb) const { return table_[bin(rgb)]; }
  /// Sets class and likeness of every point.
  void assign(Surface& surface) const;

 private:
  static constexpr std::size_t chroma_levels = 32, brightness_levels = 4;
  static constexpr std::size_t bins = chroma_levels * chroma_levels * brightness_levels;

  struct Levels;

  /// Sets the likeness of a class's colours, with mean 0 over the class.
  void set_likeness(Body body, const std::vector<double>& density);
  /// Whether a colour of points in both boxes is the object's; see learn().
  static std::vector<bool> object_bins_in_both(const Surface& surface, const PixelBox& hand_box,
                                               const PixelBox& object_box);
  static std::size_t bin(const std::array<std::uint8_t, 3>& rgb);
  /// Smoothed histogram, divided by the number of points or by `min_total`, if that is larger.
  static std::vector<double> density(const std::vector<double>& counts, double min_total);

  std::array<std::vector<double>, 3> counts_{std::vector<double>(bins), std::vector<double>(bins),
                                             std::vector<double>(bins)};  ///< by Body
  std::vector<double> far_rest_ = std::vector<double>(bins);              ///< beyond an arm's reach
  bool shares_rest_ = false;
  std::vector<Body> table_ = std::vector<Body>(bins, Body::rest);
  std::vector<float> likeness_ = std::vector<float>(bins);
};

}  // namespace touchtrace::label
