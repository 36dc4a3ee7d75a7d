#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/check/dense_reference.h"
#include "engine/model/conv_stack.h"
#include "engine/model/parameters.h"

namespace touchtrace {

/// Flat parameters and gradients, accessed by name.
struct FlatParameters {
  const ParameterTable& table;
  const std::vector<double>& values;
  std::vector<double> gradient;

  std::vector<double> operator[](const std::string& name) const;
  void set(const std::string& name, const std::vector<double>& grad);
};

/// Forward pass of a tactile encoder with the values that its backward pass needs.
struct EncoderTrace {
  std::string name;
  std::array<Conv2dShape, 3> shapes;
  std::array<std::vector<double>, 4> layers;  ///< windows, then the output of each layer
  std::array<std::vector<double>, 3> sums;    ///< pre-activations
  std::vector<double> dense, embedding;

  DenseShape dense_shape() const {
    const int windows = shapes[0].images;
    return {windows, int(layers[3].size()) / windows, int(dense.size()) / windows};
  }
  std::string conv(int layer) const { return name + ".conv" + std::to_string(layer); }
};

/// Reference of tactile_encoder.h in plain loops. `windows`: from tactile_window_reference().
EncoderTrace encode_reference(const std::string& name, const ConvStackShape& shape, int embedding,
                              const FlatParameters& parameters, std::vector<double> windows);

/// Sets the gradients of the encoder's parameters.
void encode_backward_reference(const EncoderTrace& trace, const std::vector<double>& grad_embedding,
                               FlatParameters& parameters);

}  // namespace touchtrace
