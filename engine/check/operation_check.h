#pragma once

#include <cstdint>

#include "engine/check/operation.h"

namespace touchtrace {

/// Bounds that every operation keeps on every device.
inline constexpr double output_error_bound = 8.0;         ///< in eps sqrt(n) scale
inline constexpr double gradient_error_bound = 5e-5;      ///< relative, in norm
inline constexpr double reference_gradient_bound = 1e-6;  ///< relative

/// Kernel variants of an operation that the device supports.
std::vector<KernelVariant> supported_variants(const Operation& operation, const DeviceInfo& device);

/// Inputs of a case: prepared standard normal numbers that float holds exactly, further than
/// `kink_margin` from every kink. Throws failure if no such inputs are found.
Arrays draw_inputs(const OperationCase& operation, std::uint64_t seed, double kink_margin = 0.0);

/// The worst |actual - reference| in units of eps sqrt(n) scale, as below.
double array_error(const std::vector<double>& actual, const std::vector<double>& reference,
                   double n, double underflow = 0.0);
/// ||actual - reference|| / ||reference||. Both are infinite for a NaN or another number of values.
double norm_error(const std::vector<double>& actual, std::vector<double> reference);

/// The worst |kernel - reference| of all outputs in units of eps sqrt(terms) scale, where eps is
/// float's and scale the largest reference value of its array. Infinite if a kernel gives a NaN or
/// another number of values. `underflow`: what float may lose of a value near its smallest normal.
double output_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                    double underflow = 0.0);

/// The worst ||kernel - reference|| / ||reference|| of the gradients towards the inputs, for one
/// random gradient of the outputs. Infinite as above.
double gradient_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                      std::uint64_t seed);

/// How far the reference's gradient is from its central differences along random directions,
/// relative to the gradient's expected component along one. `step`: of the differences.
double reference_gradient_error(const OperationCase& operation, const Arrays& inputs,
                                std::uint64_t seed, double step = 1e-5);

/// Where inputs stand far enough from every kink for the two gradients to be compared.
inline constexpr double gradient_kink_margin = 2e-5;

}  // namespace touchtrace
