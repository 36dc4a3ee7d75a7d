#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// What one update needs beside the arrays.
struct AdamStep {
  int count;  ///< of this update, from 1
  double learning_rate, clip_norm;
};

/// Adam with decoupled weight decay and clipping of the gradient's norm, over flat arrays.
class Adam {
 public:
  /// `decay`: weight decay of each parameter. The moments start at zero. An update with a gradient
  /// or a `loss` [1] that is not finite changes nothing. In Accuracy::exact steps below the last
  /// place of a parameter add up instead of getting lost.
  Adam(Runtime& runtime, const Buffer<float>& parameters, const Buffer<float>& gradient,
       const Buffer<float>& decay, const Buffer<float>& loss);

  void enqueue(const AdamStep& step);

  const Buffer<float>& first_moment() const { return first_; }
  const Buffer<float>& second_moment() const { return second_; }
  /// Everything that the next update depends on beside its arguments, by names for a file.
  std::vector<std::pair<std::string, Buffer<float>>> state() const;
  /// [1], of the whole gradient before clipping.
  const Buffer<float>& norm() const { return norm_; }

 private:
  Runtime& runtime_;
  Buffer<float> first_, second_, partial_, norm_;
  Buffer<float> compensation_;  ///< of parameters' last places; empty in Accuracy::fast
  Launches measure_;
  Launches update_;
};

}  // namespace touchtrace
