#include "engine/check/conv2d_reference.h"

#include <algorithm>

namespace touchtrace {
namespace {

/// Flat indices of one product of the convolution.
struct Product {
  std::size_t in, weight, out, channel;
};

/// Calls `visit` for the taps of one output value that are inside the image.
template <class Visit>
void visit_taps(const Conv2dShape& s, int image, int k, int y, int x, Visit visit) {
  const auto out =
      ((std::size_t(image) * s.out_channels + k) * s.out_rows() + y) * s.out_cols() + x;
  for (int c = 0; c < s.in_channels; ++c)
    for (int i = 0; i < s.kernel; ++i)
      for (int j = 0; j < s.kernel; ++j) {
        const int row = s.stride * y + i - s.halo(), column = s.stride * x + j - s.halo();
        if (row < 0 || row >= s.rows || column < 0 || column >= s.cols) continue;
        const auto in = ((std::size_t(image) * s.in_channels + c) * s.rows + row) * s.cols + column;
        const auto weight = ((std::size_t(k) * s.in_channels + c) * s.kernel + i) * s.kernel + j;
        visit(Product{in, weight, out, std::size_t(k)});
      }
}

template <class Visit>
void visit_products(const Conv2dShape& s, Visit visit) {
  for (int image = 0; image < s.images; ++image)
    for (int k = 0; k < s.out_channels; ++k)
      for (int y = 0; y < s.out_rows(); ++y)
        for (int x = 0; x < s.out_cols(); ++x) visit_taps(s, image, k, y, x, visit);
}

std::size_t area(const Conv2dShape& s) { return std::size_t(s.out_rows()) * s.out_cols(); }

}  // namespace

std::vector<double> conv2d_sum_reference(const Conv2dShape& s, const std::vector<double>& in,
                                         const std::vector<double>& weight,
                                         const std::vector<double>& bias) {
  std::vector<double> out(s.images * s.out_channels * area(s));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = bias[i / area(s) % s.out_channels];
  visit_products(s, [&](const Product& p) { out[p.out] += weight[p.weight] * in[p.in]; });
  return out;
}

std::vector<double> conv2d_reference(const Conv2dShape& s, const std::vector<double>& in,
                                     const std::vector<double>& weight,
                                     const std::vector<double>& bias) {
  auto out = conv2d_sum_reference(s, in, weight, bias);
  for (auto& value : out) value = std::max(value, 0.0);
  return out;
}

Conv2dGradients conv2d_backward_reference(const Conv2dShape& s, const std::vector<double>& in,
                                          const std::vector<double>& weight,
                                          const std::vector<double>& grad_sum) {
  Conv2dGradients grad{std::vector<double>(in.size()), std::vector<double>(weight.size()),
                       std::vector<double>(std::size_t(s.out_channels))};
  for (std::size_t i = 0; i < grad_sum.size(); ++i)
    grad.bias[i / area(s) % s.out_channels] += grad_sum[i];
  visit_products(s, [&](const Product& p) {
    grad.weight[p.weight] += grad_sum[p.out] * in[p.in];
    grad.in[p.in] += grad_sum[p.out] * weight[p.weight];
  });
  return grad;
}

}  // namespace touchtrace
