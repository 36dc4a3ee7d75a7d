#include <algorithm>

#include "engine/ops/conv2d_methods.h"
#include "engine/ops/lanes.h"

namespace touchtrace {
namespace {

// Work-groups that the gradient of the weights is cut into, whatever the device, so that this does
// not change the sums' order.
constexpr int wanted_groups = 512;
constexpr int depth = 16;  // terms that a tile sums at once

int quotient_up(int a, int b) { return (a + b - 1) / b; }

/// Tiles of 4096 values, as wide as they can be to divide the columns.
LanesTile lanes_tile(int columns) {
  return columns % 64 == 0 ? LanesTile{64, 64} : LanesTile{128, 32};
}

class LanesConv2d final : public Conv2d {
 public:
  LanesConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        out_tile_(lanes_tile(shape.out_channels)),
        in_tile_(lanes_tile(shape.in_channels)),
        packed_(runtime.allocate<float>(shape.weight_size())) {
    if (parameters.gradient.size() == 0) return;
    if (!shape.in_planes) packed_turned_ = runtime.allocate<float>(shape.weight_size());
    plan_chunks();
    partial_ = runtime.allocate<float>(std::size_t(all_chunks()) * sums() * shape.out_channels);
  }

  Launches prepare() override {
    Launches launches{Launch(kernel("forward", "pack", out_tile_),
                             range(shape_.out_channels, terms()), parameters_.values,
                             parameters_.weight_at, packed_)};
    if (packed_turned_.size() > 0)
      launches.push_back(Launch(kernel("data", "pack_turned", in_tile_),
                                range(shape_.in_channels, shape_.out_channels, shape_.taps()),
                                parameters_.values, parameters_.weight_at, packed_turned_));
    return launches;
  }

  Launches forward(const Conv2dImages& part) override {
    const int pixels = part.images * area();
    return {Launch(kernel("forward", "forward", out_tile_),
                   range(quotient_up(pixels, out_tile_.rows), out_groups()), part.in, packed_,
                   parameters_.values, parameters_.bias_at, part.out, part.images)
                .in_groups_of(out_tile_.items())
                .costing(conv2d_cost(shape_, part.images))
                .serving(Purpose::forward)};
  }

  Launches backward(const Conv2dImages& part, bool first) override {
    Launches launches{sum_weights(part, first)};
    if (part.grad_in.size() > 0) launches.push_back(backward_data(part));
    return launches;
  }

  Launches finish() override {
    return {Launch(kernel("weights", "reduce", out_tile_), range(shape_.out_channels, sums()),
                   partial_, all_chunks(), parameters_.gradient, parameters_.weight_at,
                   parameters_.bias_at)};
  }

 private:
  int area() const { return shape_.out_rows() * shape_.out_cols(); }
  int terms() const { return shape_.in_channels * shape_.taps(); }
  int sums() const { return terms() + 1; }  ///< of an output channel: its weights' and its bias'
  int all_chunks() const { return parameters_.sums * chunks_; }
  int out_groups() const { return shape_.out_channels / out_tile_.columns; }

  void plan_chunks() {
    const int pixels = shape_.images * area();
    const int wanted =
        quotient_up(wanted_groups, quotient_up(sums(), out_tile_.rows) * out_groups());
    chunk_pixels_ = quotient_up(quotient_up(pixels, wanted), depth) * depth;
    chunks_ = quotient_up(pixels, chunk_pixels_);
  }

  Launch sum_weights(const Conv2dImages& part, bool first) {
    return Launch(kernel("weights", "weights", out_tile_),
                  range(quotient_up(sums(), out_tile_.rows), out_groups(), chunks_), part.in,
                  part.grad_out, partial_, part.images, chunk_pixels_, part.sums * chunks_,
                  first ? 1 : 0)
        .in_groups_of(out_tile_.items())
        .costing(conv2d_cost(shape_, part.images))
        .serving(Purpose::weights_gradient);
  }

  Launch backward_data(const Conv2dImages& part) {
    return Launch(kernel("data", "data", in_tile_),
                  range(quotient_up(part.images * area(), in_tile_.rows),
                        shape_.in_channels / in_tile_.columns, shape_.stride * shape_.stride),
                  part.grad_out, packed_turned_, part.in, part.grad_in, part.images)
        .in_groups_of(in_tile_.items())
        .costing(conv2d_cost(shape_, part.images))
        .serving(Purpose::data_gradient);
  }

  Kernel kernel(const std::string& pass, const std::string& name, const LanesTile& tile) {
    auto defines = pass == "forward" ? conv2d_forward_defines(shape_) : conv2d_defines(shape_);
    tile.define(defines);
    return runtime_.kernel({"common.clh", "lanes.clh", "conv2d.clh", "conv2d_lanes.clh",
                            "conv2d_lanes_" + pass + ".cl"},
                           "conv2d_lanes_" + name, defines);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  LanesTile out_tile_, in_tile_;
  int chunk_pixels_ = 0, chunks_ = 0;
  Buffer<float> packed_, packed_turned_, partial_;
};

}  // namespace

std::unique_ptr<Conv2d> make_conv2d_lanes(Runtime& runtime, const Conv2dShape& shape,
                                          const Conv2dParameters& parameters) {
  return std::make_unique<LanesConv2d>(runtime, shape, parameters);
}

}  // namespace touchtrace
