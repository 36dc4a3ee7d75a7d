#include "engine/ops/conv2d.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

std::size_t size_with_halo(int planes, int rows, int cols, int halo) {
  return std::size_t(planes) * (rows + 2 * halo) * (cols + 2 * halo);
}

/// Whether the taps of output pixel (y, x) read an input pixel whose `live` is 1.
bool reads_live(const Conv2dShape& s, const std::vector<std::uint8_t>& live, int y, int x) {
  const int first_row = s.stride * y - s.halo(), first_col = s.stride * x - s.halo();
  for (int row = std::max(first_row, 0); row < std::min(first_row + s.kernel, s.rows); ++row)
    for (int col = std::max(first_col, 0); col < std::min(first_col + s.kernel, s.cols); ++col)
      if (live[std::size_t(row) * s.cols + col]) return true;
  return false;
}

/// All output pixels, dead ones last, in the format of kernels/conv2d.clh: "2,3,0,1".
std::string order_of(const Conv2dShape& shape) {
  std::vector<int> order(std::size_t(shape.out_rows()) * shape.out_cols());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_partition(
      order, [&](int pixel) { return !std::ranges::binary_search(shape.dead, pixel); });
  return fmt::format("{}", fmt::join(order, ","));
}

}  // namespace

std::size_t Conv2dShape::in_size() const {
  return size_with_halo(images * in_channels, rows, cols, halo());
}

std::size_t Conv2dShape::out_size() const {
  return size_with_halo(images * out_channels, out_rows(), out_cols(), out_halo());
}

std::size_t Conv2dShape::grad_out_size() const {
  return size_with_halo(images * out_channels, out_rows(), out_cols(), halo());
}

double Conv2dShape::flops() const {
  const int live = out_rows() * out_cols() - static_cast<int>(dead.size());
  return 2.0 * taps() * images * in_channels * out_channels * live;
}

std::vector<int> dead_pixels(const Conv2dShape& shape, const std::vector<std::uint8_t>& live) {
  std::vector<int> dead;
  for (int y = 0; y < shape.out_rows(); ++y)
    for (int x = 0; x < shape.out_cols(); ++x)
      if (!reads_live(shape, live, y, x)) dead.push_back(y * shape.out_cols() + x);
  return dead;
}

Defines conv2d_defines(const Conv2dShape& shape) {
  Defines defines{{"IN_CHANNELS", std::to_string(shape.in_channels)},
                  {"OUT_CHANNELS", std::to_string(shape.out_channels)},
                  {"IN_ROWS", std::to_string(shape.rows)},
                  {"IN_COLS", std::to_string(shape.cols)},
                  {"KERNEL", std::to_string(shape.kernel)},
                  {"STRIDE", std::to_string(shape.stride)}};
  if (shape.in_planes) defines.emplace("IN_PLANES", "1");
  if (!shape.dead.empty()) {
    const auto live = shape.out_rows() * shape.out_cols() - static_cast<int>(shape.dead.size());
    defines.insert({{"LIVE", std::to_string(live)}, {"ORDER", order_of(shape)}});
  }
  return defines;
}

Defines conv2d_forward_defines(const Conv2dShape& shape) {
  auto defines = conv2d_defines(shape);
  if (shape.compact_output) defines.emplace("OUT_HALO", "0");
  return defines;
}

LaunchCost conv2d_cost(const Conv2dShape& shape, int images) {
  const double share = static_cast<double>(images) / shape.images;
  const double values = share * static_cast<double>(shape.in_size() + shape.out_size());
  return {share * shape.flops(), 4.0 * (values + static_cast<double>(shape.weight_size()))};
}

bool winograd_applies(const Conv2dShape& shape) {
  return shape.kernel == 3 && shape.stride == 2 && !shape.in_planes;
}

Conv2dMethod best_method(const Conv2dShape& shape) {
  if (!winograd_applies(shape)) return Conv2dMethod::direct;
  const int tiles = ceil_div(shape.out_rows(), 4) * ceil_div(shape.out_cols(), 4);
  return 81 * tiles < 9 * shape.out_rows() * shape.out_cols() ? Conv2dMethod::winograd
                                                              : Conv2dMethod::direct;
}

std::unique_ptr<Conv2d> make_conv2d(Runtime& runtime, const Conv2dShape& shape,
                                    const Conv2dParameters& parameters, Conv2dMethod method) {
  if (runtime.kernel_variant() == KernelVariant::gpu)
    return make_conv2d_gpu(runtime, shape, parameters);
  const bool winograd = method == Conv2dMethod::winograd && winograd_applies(shape) &&
                        runtime.accuracy() == Accuracy::fast && winograd_group(runtime, shape) > 0;
  return (winograd ? make_conv2d_winograd : make_conv2d_direct)(runtime, shape, parameters);
}

}  // namespace touchtrace
