#include "engine/ops/conv2d.h"

#include "engine/ops/conv2d_methods.h"

namespace touchtrace {

std::size_t Conv2dShape::in_size() const {
  return static_cast<std::size_t>(images) * in_channels * (rows + 2 * halo()) * (cols + 2 * halo());
}

std::size_t Conv2dShape::out_size() const {
  return static_cast<std::size_t>(images) * out_channels * (out_rows() + 2 * halo()) *
         (out_cols() + 2 * halo());
}

double Conv2dShape::flops() const {
  return 2.0 * taps() * images * in_channels * out_channels * out_rows() * out_cols();
}

Defines conv2d_defines(const Conv2dShape& shape) {
  Defines defines{{"IN_CHANNELS", std::to_string(shape.in_channels)},
                  {"OUT_CHANNELS", std::to_string(shape.out_channels)},
                  {"IN_ROWS", std::to_string(shape.rows)},
                  {"IN_COLS", std::to_string(shape.cols)},
                  {"KERNEL", std::to_string(shape.kernel)},
                  {"STRIDE", std::to_string(shape.stride)}};
  if (shape.in_planes) defines.emplace("IN_PLANES", "1");
  return defines;
}

LaunchCost conv2d_cost(const Conv2dShape& shape, int images) {
  const double share = static_cast<double>(images) / shape.images;
  const double values = share * static_cast<double>(shape.in_size() + shape.out_size());
  return {share * shape.flops(), 4.0 * (values + static_cast<double>(shape.weight_size()))};
}

namespace {

bool winograd_applies(const Conv2dShape& shape) {
  return shape.kernel == 3 && shape.stride == 2 && !shape.in_planes;
}

}  // namespace

Conv2dMethod best_method(const Conv2dShape& shape) {
  if (!winograd_applies(shape)) return Conv2dMethod::direct;
  const int tiles = ((shape.out_rows() + 3) / 4) * ((shape.out_cols() + 3) / 4);
  return 81 * tiles < 9 * shape.out_rows() * shape.out_cols() ? Conv2dMethod::winograd
                                                              : Conv2dMethod::direct;
}

std::unique_ptr<Conv2d> make_conv2d(Runtime& runtime, const Conv2dShape& shape,
                                    const Conv2dParameters& parameters,
                                    const Conv2dChoice& choice) {
  const bool winograd = choice.method == Conv2dMethod::winograd && winograd_applies(shape) &&
                        winograd_group(runtime, shape, choice) > 0;
  return (winograd ? make_conv2d_winograd : make_conv2d_direct)(runtime, shape, parameters, choice);
}

}  // namespace touchtrace
