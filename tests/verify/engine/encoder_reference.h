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

/// Forward pass of an encoder's convolutions with the values that the backward pass needs.
struct ConvStackTrace {
  std::string name;
  std::array<Conv2dShape, 3> shapes;
  std::array<std::vector<double>, 4> layers;  ///< windows, then the output of each layer
  std::array<std::vector<double>, 3> sums;    ///< pre-activations

  std::string conv(int layer) const { return name + ".conv" + std::to_string(layer); }
};

/// Forward pass of a tactile encoder.
struct EncoderTrace : ConvStackTrace {
  std::vector<double> dense, embedding;

  DenseShape dense_shape() const {
    const int windows = shapes[0].images;
    return {windows, int(layers[3].size()) / windows, int(dense.size()) / windows};
  }
};

/// Reference of conv_stack.h in plain loops. `windows`: from tactile_window_reference().
ConvStackTrace conv_stack_reference(const std::string& name, const ConvStackShape& shape,
                                    const FlatParameters& parameters, std::vector<double> windows);

/// Sets the gradients of weights and biases.
void conv_stack_backward_reference(const ConvStackTrace& trace, std::vector<double> grad_features,
                                   FlatParameters& parameters);

/// Reference of tactile_encoder.h in plain loops. `windows`: from tactile_window_reference().
EncoderTrace encode_reference(const std::string& name, const ConvStackShape& shape, int embedding,
                              const FlatParameters& parameters, std::vector<double> windows);

/// Sets the gradients of the encoder's parameters.
void encode_backward_reference(const EncoderTrace& trace, const std::vector<double>& grad_embedding,
                               FlatParameters& parameters);

}  // namespace touchtrace
