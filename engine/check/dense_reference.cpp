#include "engine/check/dense_reference.h"

#include <cstddef>

namespace touchtrace {
namespace {

/// Calls `visit` with the flat indices of in, weight and out of every product.
template <class Visit>
void visit_products(const DenseShape& s, Visit visit) {
  for (std::size_t row = 0; row < std::size_t(s.rows); ++row)
    for (std::size_t o = 0; o < std::size_t(s.outputs); ++o)
      for (std::size_t i = 0; i < std::size_t(s.inputs); ++i)
        visit(row * s.inputs + i, o * s.inputs + i, row * s.outputs + o);
}

}  // namespace

std::vector<double> dense_reference(const DenseShape& s, const std::vector<double>& in,
                                    const std::vector<double>& weight,
                                    const std::vector<double>& bias) {
  std::vector<double> out(std::size_t(s.rows) * s.outputs, 0.0);
  if (!bias.empty())
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = bias[i % s.outputs];
  visit_products(s, [&](auto i, auto w, auto o) { out[o] += in[i] * weight[w]; });
  return out;
}

DenseGradients dense_backward_reference(const DenseShape& s, const std::vector<double>& in,
                                        const std::vector<double>& weight,
                                        const std::vector<double>& grad_out) {
  DenseGradients grad{std::vector<double>(in.size()), std::vector<double>(weight.size()),
                      std::vector<double>(std::size_t(s.outputs))};
  for (std::size_t i = 0; i < grad_out.size(); ++i) grad.bias[i % s.outputs] += grad_out[i];
  visit_products(s, [&](auto i, auto w, auto o) {
    grad.in[i] += grad_out[o] * weight[w];
    grad.weight[w] += grad_out[o] * in[i];
  });
  return grad;
}

}  // namespace touchtrace
