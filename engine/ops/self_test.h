#pragma once

#include <string>
#include <vector>

#include "engine/cl/runtime.h"

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

/// Runs every row of the table of operations on a device against the references in double. Never
/// throws for what the device does wrong: that is in the results.
std::vector<OperationResult> self_test(Runtime& runtime);

/// PoCL in the place of a device that `fault` speaks against, with a warning on stderr. Throws
/// device_error if there is no PoCL.
ChosenDevice pocl_instead_of(const ChosenDevice& refused, const std::string& fault);

/// choose_device(wish), tested first unless it is PoCL. A device that fails the test is refused
/// with a warning on stderr, and PoCL is used instead. Throws device_error if there is no PoCL
/// either.
ChosenDevice usable_device(const std::string& wish);

}  // namespace touchtrace
