#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// Flat arrays of double: the inputs, outputs or gradients of an operation, in its own order.
using Arrays = std::vector<std::vector<double>>;

/// An operation at one shape: what the kernels do and what a plain loop in double does. Tests,
/// `doctor` and the check of a device at start all follow from these six functions.
///
/// The kernels are given inputs that float holds exactly. Gradients belong to the scalar
/// sum(output * output_gradient) and come as one array an input, empty where an input has none.
struct OperationCase {
  std::string shape;  ///< "3 images of 10x32x32 to 32 channels"
  std::vector<std::size_t> input_sizes;
  double terms;                 ///< n: summands behind one output value, for error bounds
  double gradient_terms = 1.0;  ///< the same for the gradients
  std::function<Arrays(const Arrays& inputs)> reference;
  std::function<Arrays(Runtime&, const Arrays& inputs)> forward;
  /// Both empty for operations without gradient.
  std::function<Arrays(const Arrays& inputs, const Arrays& output_gradients)> reference_backward;
  std::function<Arrays(Runtime&, const Arrays& inputs, const Arrays& output_gradients)> backward;
  /// How far the inputs stand from the nearest kink (of ReLU, L1, pinball); tests draw inputs again
  /// while it is too small. Empty: there are none.
  std::function<double(const Arrays& inputs)> kink_distance;
  /// Turns standard normal numbers into valid inputs (indices, positive values). Empty: as they
  /// are.
  std::function<void(Arrays& inputs)> prepare;
};

/// One operation of the engine. The first case is small enough for every start and uses every
/// kernel; the others hold odd sizes and the model's own shapes.
struct Operation {
  std::string name;
  std::vector<OperationCase> cases;
  std::size_t small_cases = 1;   ///< the first ones, small enough for oclgrind
  bool has_gpu_variant = false;  ///< has kernels of KernelVariant::gpu
};

/// The table of operations: one row each, in operations.cpp.
const std::vector<Operation>& operations();

}  // namespace touchtrace
