#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// Milliseconds that the usual rule and the choice took when they were compared.
struct TunedTimes {
  double usual_ms = 0.0, chosen_ms = 0.0;
};

/// What was measured to be fastest on one device, for training. The same choices give the same
/// bits, others give others; a shape without one goes by the rules that suit most devices.
struct Tuning {
  struct Layer {
    Conv2dShape shape;
    Conv2dChoice choice;
    TunedTimes times{};
  };
  /// Images that go through all layers together, since what one layer writes may still be in the
  /// cache when the next one reads it.
  struct Part {
    Conv2dShape first_layer;  ///< with the images of all parts
    int images;
    TunedTimes times{};
  };

  std::vector<Layer> layers;
  std::vector<Part> parts;

  /// That of a shape, dead pixels aside, or else of the same layer with the nearest number of
  /// images: a layer with at most twice as many or half of them, since methods pay from some number
  /// of images on; a part with any. Null without such a one.
  const Layer* layer(const Conv2dShape& shape) const;
  const Part* part(const Conv2dShape& first_layer) const;
  /// In the place of those of the same shape.
  void set(const Layer& layer);
  void set(const Part& part);
};

}  // namespace touchtrace
