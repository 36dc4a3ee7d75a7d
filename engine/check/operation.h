#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// Inputs, outputs or gradients of an operation: flat arrays, in the operation's order.
using Arrays = std::vector<std::vector<double>>;

/// An operation at one shape, computed by the kernels and by plain loops in double. Used by the
/// tests, `self-test`, `doctor` and the test of a device at start.
///
/// Inputs are exact in float. Gradients are those of the scalar sum(output * output_gradient), one
/// array per input, empty for inputs without gradient.
struct OperationCase {
  std::string shape;  ///< "3 images of 10x32x32 to 32 channels"
  std::vector<std::size_t> input_sizes;
  double terms;  ///< number of summands behind one output value, for error bounds
  std::function<Arrays(const Arrays& inputs)> reference;
  std::function<Arrays(Runtime&, const Arrays& inputs)> forward;
  /// Both empty if the operation has no gradient.
  std::function<Arrays(const Arrays& inputs, const Arrays& output_gradients)> reference_backward;
  std::function<Arrays(Runtime&, const Arrays& inputs, const Arrays& output_gradients)> backward;
  /// Distance of the inputs to the nearest kink of ReLU, L1 or pinball; inputs are drawn again
  /// while it is too small. Empty: no kinks.
  std::function<double(const Arrays& inputs)> kink_distance;
  /// Turns standard normal numbers into valid inputs (indices, positive values). Empty: identity.
  std::function<void(Arrays& inputs)> prepare;
};

/// One operation of the engine. The first case runs at every start, so it is small; it uses every
/// kernel of the operation. The others cover odd sizes and the model's shapes.
struct Operation {
  std::string name;
  std::vector<OperationCase> cases;
  std::size_t small_cases = 1;   ///< number of leading cases that are small enough for oclgrind
  bool has_gpu_variant = false;  ///< has kernels of KernelVariant::gpu
};

/// All operations: one row each, in operations.cpp.
const std::vector<Operation>& operations();

}  // namespace touchtrace
