#pragma once

#include <string>

#include "engine/model/dynamics.h"

namespace touchtrace {

/// Last layer of the dynamics, from hidden values to [delta, band]; evaluated by the roll-out.
class DynamicsOutput {
 public:
  /// Adds "NAME.weight" [2 state, hidden] and "NAME.bias" [2 state].
  static void declare(const ModelSpec& spec, const std::string& name, ParameterTable& table);

  DynamicsOutput(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                 const std::string& name);

  /// `h`: [rows, hidden]. `grad_output`: [rows, 2, 16] with respect to delta and band.
  void plan_backward(Runtime& runtime, const Buffer<float>& grad_output, const MatrixView& h,
                     int rows);

  const Launches& prepare() const { return prepare_; }
  const Launches& backward() const { return backward_; }

  // Arguments of the roll-out kernels:
  int weight_at() const { return weights_.value(name_ + ".weight").at; }
  const Buffer<float>& weight() const { return weight_; }  ///< [hidden, 2, 16], zero-padded
  const Buffer<float>& bias() const { return bias_; }      ///< [2, 16], zero-padded

 private:
  ModelSpec spec_;
  Weights weights_;
  std::string name_;
  Buffer<float> weight_, bias_;
  Launches prepare_, backward_;
};

}  // namespace touchtrace
