#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/ops/conv2d.h"
#include "engine/train/trial.h"

namespace touchtrace {

/// Results of a layer in an update.
struct LayerResults {
  std::vector<double> out, grad_in, gradient;
};

/// Whether the results of two variants agree within twice the bounds of operation_check.h, which
/// hold for each against the double reference.
bool agree(const Conv2dShape& shape, const LayerResults& results, const LayerResults& reference);

/// Training variants of a convolution, on random data. The first variant is the reference.
class LayerTrials {
 public:
  /// `micro_batches`: number of micro-batches of shape.images images each.
  LayerTrials(Runtime& runtime, const Conv2dShape& shape, int micro_batches);

  /// Returns nullopt if the device rejects the variant or its results disagree with the first's.
  /// The trial must not outlive this object.
  std::optional<Trial> make(const Conv2dChoice& choice);

 private:
  /// Launches of the layer in an update.
  Launches pass(Conv2d& layer) const;
  LayerResults results(const Launches& launches);

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  std::vector<Conv2dMicroBatch> micro_batches_;
  std::optional<LayerResults> reference_;
};

}  // namespace touchtrace
