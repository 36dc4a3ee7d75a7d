#pragma once

#include <memory>

#include "engine/ops/conv2d.h"
#include "engine/train/trial.h"

namespace touchtrace {

/// What an update computes of a layer.
struct LayerResults {
  std::vector<double> out, grad_in, gradient;
};

/// Whether results are those of another way within twice the bounds of operation_check.h, which
/// hold for both against plain loops.
bool agree(const Conv2dShape& shape, const LayerResults& results, const LayerResults& others);

/// Ways to train a convolution, on noise. The first one sets what others must agree with.
class LayerTrials {
 public:
  /// `parts`: of shape.images images each.
  LayerTrials(Runtime& runtime, const Conv2dShape& shape, int parts);

  /// Empty if the device refuses this way, or if its results do not agree with the first one's.
  /// Valid as long as this object.
  std::optional<Trial> make(const Conv2dChoice& choice);

 private:
  /// An update's share of the layer.
  Launches pass(Conv2d& layer) const;
  LayerResults results(const Launches& launches);

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  std::vector<Conv2dImages> parts_;
  std::optional<LayerResults> first_;
};

}  // namespace touchtrace
