#include "engine/ops/conv2d.h"

#include "engine/ops/conv2d_methods.h"

namespace touchtrace {

std::size_t Conv2dShape::in_size() const {
  return static_cast<std::size_t>(images) * in_channels * (rows + 2) * (cols + 2);
}

std::size_t Conv2dShape::out_size() const {
  return static_cast<std::size_t>(images) * out_channels * (out_rows() + 2) * (out_cols() + 2);
}

double Conv2dShape::flops() const {
  return 18.0 * images * in_channels * out_channels * out_rows() * out_cols();
}

Defines conv2d_defines(const Conv2dShape& shape) {
  Defines defines{{"IN_CHANNELS", std::to_string(shape.in_channels)},
                  {"OUT_CHANNELS", std::to_string(shape.out_channels)},
                  {"IN_ROWS", std::to_string(shape.rows)},
                  {"IN_COLS", std::to_string(shape.cols)}};
  if (shape.in_planes) defines.emplace("IN_PLANES", "1");
  return defines;
}

LaunchCost conv2d_cost(const Conv2dShape& shape, int images) {
  const double share = static_cast<double>(images) / shape.images;
  const double values = share * static_cast<double>(shape.in_size() + shape.out_size());
  return {share * shape.flops(), 4.0 * (values + static_cast<double>(shape.weight_size()))};
}

Conv2dMethod best_method(const Conv2dShape& shape) {
  const int tiles = ((shape.out_rows() + 3) / 4) * ((shape.out_cols() + 3) / 4);
  return 81 * tiles < 9 * shape.out_rows() * shape.out_cols() ? Conv2dMethod::winograd
                                                              : Conv2dMethod::direct;
}

std::unique_ptr<Conv2d> make_conv2d(Runtime& runtime, const Conv2dShape& shape,
                                    const Conv2dParameters& parameters, Conv2dMethod method) {
  const bool winograd =
      method == Conv2dMethod::winograd && !shape.in_planes && winograd_group(runtime, shape) > 0;
  return (winograd ? make_conv2d_winograd : make_conv2d_direct)(runtime, shape, parameters);
}

}  // namespace touchtrace
