#pragma once

#include <string>
#include <vector>

#include "engine/check/operation.h"

namespace touchtrace {

/// How one operation did on one device, at its smallest shape.
struct OperationResult {
  std::string operation;
  double output_error = 0.0;  ///< in eps sqrt(n) scale; bound: output_error_bound
  double gradient_error =
      0.0;            ///< relative, in norm; bound: gradient_error_bound; 0 without gradient
  std::string fault;  ///< why it did not run; empty if it did

  bool holds() const;
};

/// Runs an operation on a device against its reference in double. Never throws for what the device
/// does wrong: that is in the result.
OperationResult self_test(Runtime& runtime, const Operation& operation);

/// The same for every row of the table of operations.
std::vector<OperationResult> self_test(Runtime& runtime);

}  // namespace touchtrace
