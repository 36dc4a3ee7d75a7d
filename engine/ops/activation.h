#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Between the layers of the dynamics MLP (kernels/dynamics.clh). The smooth ones have a gradient
/// without kinks, which long roll-outs may profit from.
enum class Activation {
  relu,  ///< max(x, 0)
  silu,  ///< x / (1 + exp(-x)) (Elfwing et al. 2018)
  tanh,
};

/// "relu", "silu", "tanh": in options and model files.
std::string_view name_of(Activation activation);
/// The value of a kernel's -D ACTIVATION.
inline std::string kernel_name_of(Activation activation) {
  return "activation_" + std::string(name_of(activation));
}
/// Throws usage_error for a name that is none.
Activation activation_of(std::string_view name);

/// Whether the gradient is computed from the sum x rather than from the value.
inline bool slope_from_sum(Activation activation) { return activation == Activation::silu; }
/// Whether the slope jumps at x = 0.
inline bool has_kink(Activation activation) { return activation == Activation::relu; }

/// Of every sum, in plain double: the values, and the slopes times `grad`.
std::vector<double> activation_reference(Activation activation, std::vector<double> sums);
std::vector<double> activation_backward_reference(Activation activation,
                                                  const std::vector<double>& sums,
                                                  std::vector<double> grad);

}  // namespace touchtrace
