#pragma once

#include <optional>
#include <vector>

#include "engine/model/conv_stack.h"
#include "engine/train/trial.h"

namespace touchtrace {

/// Training variants of the convolutions of an encoder, on random data. The first variant is the
/// reference.
class EncoderTrials {
 public:
  EncoderTrials(Runtime& runtime, const ConvStackShape& shape);

  /// Returns nullopt if the device rejects the variant; if the features are not bitwise equal to
  /// the first's (no sum of the forward pass is over windows); or if the gradient differs from the
  /// first's by more than twice the bound of operation_check.h. The trial must not outlive this
  /// object.
  std::optional<Trial> make(const Tuning& tuning);

 private:
  struct Results {
    std::vector<float> features;
    std::vector<double> gradient;
  };
  void pass(ConvStack& encoder) const;
  Results results(ConvStack& encoder) const;

  Runtime& runtime_;
  ConvStackShape shape_;
  ParameterTable table_;
  Weights weights_;
  Buffer<float> stream_;
  Buffer<int> window_end_;
  std::optional<Results> reference_;
};

}  // namespace touchtrace
