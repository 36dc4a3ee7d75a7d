#pragma once

#include <array>
#include <string>

#include "engine/base/options.h"
#include "engine/model/model_spec.h"

namespace touchtrace::study {

/// Model of `train` and `plan`.
struct ModelOptions {
  bool without_touch = false;
  int window = 10;
  int resolution = 0;  ///< of image_shape()
  std::string tactile_kernel = "3", tactile_strides = "2,2,2";
  std::string dynamics = "mlp";         ///< or "gru"
  std::string object_encoder = "auto";  ///< "none", "frozen", "joint"; "auto": none or frozen

  int kernel_size() const { return tactile_kernel[0] - '0'; }
  std::array<int, 3> stride_sizes() const {
    return {tactile_strides[0] - '0', tactile_strides[2] - '0', tactile_strides[4] - '0'};
  }
};

/// Adds the options as group "Model". Choices are what the OpenCL kernels support.
void describe(OptionSet& set, ModelOptions& options);

/// Specification of the model for tactile images of `rows` x `cols`. Without touch, or with one
/// object, there is no object encoder, whatever the options: objects are identified by touch, and
/// one needs no identification. Throws usage_error for images smaller than 6 x 6.
ModelSpec make_spec(const ModelOptions& options, int rows, int cols, std::size_t num_objects);

}  // namespace touchtrace::study
