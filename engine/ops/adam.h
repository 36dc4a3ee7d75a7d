#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Scalars of one update.
struct AdamStep {
  int count;  ///< number of this update, from 1
  double learning_rate, clip_norm;
};

/// AdamW: Adam with decoupled weight decay (Loshchilov and Hutter 2019) and clipping of the
/// gradient norm, over flat arrays of equal size (kernels/adam.cl).
class Adam {
 public:
  /// `decay`: weight decay of each parameter; `loss`: [1]. Moments start at zero. An update whose
  /// gradient or loss is not finite changes nothing. Accuracy::exact compensates the rounding of
  /// parameters, so that steps below one unit in the last place accumulate.
  Adam(Runtime& runtime, const Buffer<float>& parameters, const Buffer<float>& gradient,
       const Buffer<float>& decay, const Buffer<float>& loss);

  void enqueue(const AdamStep& step);

  const Buffer<float>& first_moment() const { return first_; }
  const Buffer<float>& second_moment() const { return second_; }
  /// Arrays that the next update depends on, with their names in a checkpoint.
  std::vector<std::pair<std::string, Buffer<float>>> state() const;
  /// [1] Norm of the gradient before clipping.
  const Buffer<float>& norm() const { return norm_; }

 private:
  Runtime& runtime_;
  Buffer<float> first_, second_, partial_, norm_;
  Buffer<float> compensation_;  ///< rounding errors of the parameters; empty in Accuracy::fast
  Launches measure_;
  Launches update_;
};

}  // namespace touchtrace
