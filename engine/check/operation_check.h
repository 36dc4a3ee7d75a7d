#pragma once

#include <cstdint>

#include "engine/check/operation.h"

namespace touchtrace {

/// Error bounds of every operation on every device.
inline constexpr double output_error_bound = 8.0;         ///< unit: eps sqrt(n) scale
inline constexpr double gradient_error_bound = 5e-5;      ///< relative, norm-wise
inline constexpr double reference_gradient_bound = 1e-6;  ///< relative

/// Draws inputs of a case: prepared standard normal numbers, exact in float, farther than
/// `kink_margin` from every kink. Throws failure if it finds none.
Arrays draw_inputs(const OperationCase& operation, std::uint64_t seed, double kink_margin = 0.0);

/// Largest |actual - reference| in units of eps sqrt(n) scale; see output_error().
double array_error(const std::vector<double>& actual, const std::vector<double>& reference,
                   double n, double underflow = 0.0);
/// ||actual - reference|| / ||reference||. Both functions return infinity for NaN or unequal sizes.
double norm_error(const std::vector<double>& actual, std::vector<double> reference);

/// Largest |kernel - reference| of all outputs in units of eps sqrt(terms) scale: eps of float,
/// scale the largest reference magnitude of the array. Infinite for NaN or unequal sizes.
/// `underflow`: absolute error that is allowed near float's smallest normal number.
double output_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                    double underflow = 0.0);

/// Largest ||kernel - reference|| / ||reference|| of the input gradients for one random output
/// gradient. Infinite for NaN or unequal sizes.
double gradient_error(Runtime& runtime, const OperationCase& operation, const Arrays& inputs,
                      std::uint64_t seed);

/// Difference between the reference's gradient and its central differences of step `step` along
/// random directions, relative to the gradient's expected component along a direction.
double reference_gradient_error(const OperationCase& operation, const Arrays& inputs,
                                std::uint64_t seed, double step = 1e-5);

/// Distance to kinks at which gradients of float kernels and of the reference are comparable.
inline constexpr double gradient_kink_margin = 2e-5;

}  // namespace touchtrace
