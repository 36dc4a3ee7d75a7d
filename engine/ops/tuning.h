#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// Times of the default and of the tuned configuration when they were compared.
struct TunedTimes {
  double default_ms = 0.0, tuned_ms = 0.0;
};

/// Fastest configurations for training, measured on one device. Shapes without an entry use the
/// default configuration. Another tuning changes the last bits of the result.
struct Tuning {
  struct Layer {
    Conv2dShape shape;
    Conv2dChoice choice;
    TunedTimes times{};
  };
  /// Number of images that go through all layers together, so that the output of a layer may still
  /// be in the cache when the next one reads it.
  struct MicroBatch {
    Conv2dShape first_layer;  ///< with the images of all micro-batches
    int images;
    TunedTimes times{};
  };

  std::vector<Layer> layers;
  std::vector<MicroBatch> micro_batches;

  /// Entry of the shape, dead pixels ignored, or of the same layer with the nearest number of
  /// images; null if there is none. Numbers of a layer differ at most by a factor of 2, because the
  /// fastest method depends on the number of images.
  const Layer* layer(const Conv2dShape& shape) const;
  const MicroBatch* micro_batch(const Conv2dShape& first_layer) const;
  /// Adds an entry or replaces that of the same shape.
  void set(const Layer& layer);
  void set(const MicroBatch& batch);
};

}  // namespace touchtrace
