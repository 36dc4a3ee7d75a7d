#pragma once

#include <string>
#include <vector>

#include "engine/check/operation.h"

namespace touchtrace {

/// Result of one operation on one device, at its first case.
struct OperationResult {
  std::string operation;
  double output_error = 0.0;    ///< unit: eps sqrt(n) scale; bound: output_error_bound
  double gradient_error = 0.0;  ///< relative; bound: gradient_error_bound; 0 without gradient
  std::string fault;            ///< why it did not run; empty if it did

  bool passes() const;
};

/// Compares an operation on a device with its reference. Faults of the device are in the result,
/// not thrown.
OperationResult self_test(Runtime& runtime, const Operation& operation);

}  // namespace touchtrace
