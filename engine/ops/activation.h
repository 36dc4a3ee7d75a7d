#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Activation function of the dynamics MLP (kernels/dynamics.clh).
enum class Activation {
  relu,  ///< max(x, 0)
  silu,  ///< x / (1 + exp(-x)) (Elfwing et al. 2018)
  tanh,
};

/// "relu", "silu", "tanh", as in options and model files.
std::string_view name_of(Activation activation);
/// Value of a kernel's -D ACTIVATION.
inline std::string kernel_name_of(Activation activation) {
  return "activation_" + std::string(name_of(activation));
}
/// Throws usage_error for an unknown name.
Activation activation_of(std::string_view name);

/// Whether the derivative is computed from the pre-activation x; otherwise from the output.
inline bool slope_from_sum(Activation activation) { return activation == Activation::silu; }
/// Whether the derivative is discontinuous at x = 0.
inline bool has_kink(Activation activation) { return activation == Activation::relu; }

/// Outputs for the pre-activations `sums`, and `grad` times the derivatives there, in double.
std::vector<double> activation_reference(Activation activation, std::vector<double> sums);
std::vector<double> activation_backward_reference(Activation activation,
                                                  const std::vector<double>& sums,
                                                  std::vector<double> grad);

}  // namespace touchtrace
