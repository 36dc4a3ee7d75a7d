#pragma once

#include <string>

#include "engine/model/dynamics.h"

namespace touchtrace {

/// The last layer of the dynamics: from hidden values [delta, band].
class DynamicsOutput {
 public:
  /// Adds "NAME.weight" [2 state, hidden] and "NAME.bias" [2 state].
  static void declare(const ModelSpec& spec, const std::string& name, ParameterTable& table);

  DynamicsOutput(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                 const std::string& name);

  /// `h`: [rows, hidden]; `d_out`: [rows, 2, 16], towards delta and band.
  void plan_backward(Runtime& runtime, const Buffer<float>& d_out, const MatrixView& h, int rows);

  const Launches& prepare() const { return prepare_; }
  const Launches& backward() const { return backward_; }

  // As the kernels of the roll-outs take them.
  int weight_at() const { return weights_.value(name_ + ".weight").at; }
  const Buffer<float>& weight() const { return weight_; }  ///< [hidden, 2, 16], padded
  const Buffer<float>& bias() const { return bias_; }      ///< [2, 16], padded

 private:
  ModelSpec spec_;
  Weights weights_;
  std::string name_;
  Buffer<float> weight_, bias_;
  Launches prepare_, backward_;
};

}  // namespace touchtrace
