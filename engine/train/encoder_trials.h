#pragma once

#include "engine/model/tactile_encoder.h"
#include "engine/train/trial.h"

namespace touchtrace {

/// Ways to train the convolutions of an encoder, on noise. The first one sets what others must
/// agree with.
class EncoderTrials {
 public:
  EncoderTrials(Runtime& runtime, const TactileEncoderShape& shape);

  /// Empty if the device refuses this way; if the features are not the same bits as those of the
  /// first, since no sum of the forward pass goes over windows; or if the gradient is not that of
  /// the first within twice the bound of operation_check.h. Valid as long as this object.
  std::optional<Trial> make(const Tuning& tuning);

 private:
  struct Results {
    std::vector<float> features;
    std::vector<double> gradient;
  };
  void pass(TactileEncoder& encoder) const;
  Results results(TactileEncoder& encoder) const;

  Runtime& runtime_;
  TactileEncoderShape shape_;
  ParameterTable table_;
  Weights weights_;
  Buffer<float> stream_;
  Buffer<int> last_frame_;
  std::optional<Results> first_;
};

}  // namespace touchtrace
