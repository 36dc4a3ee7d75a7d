#pragma once

#include <array>
#include <string>

#include "engine/base/options.h"

namespace touchtrace::study {

/// Options of the tactile convolutions, for ModelSpec.
struct ConvolutionOptions {
  std::string kernel = "3", strides = "2,2,2";

  int kernel_size() const { return kernel[0] - '0'; }
  std::array<int, 3> stride_sizes() const {
    return {strides[0] - '0', strides[2] - '0', strides[4] - '0'};
  }
};

/// Adds --tactile-kernel and --tactile-strides. Choices are what the OpenCL kernels support.
void describe(OptionSet& set, ConvolutionOptions& options);

}  // namespace touchtrace::study
