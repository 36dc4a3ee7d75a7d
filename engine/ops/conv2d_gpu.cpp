#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"
#include "engine/ops/gpu_tile.h"

namespace touchtrace {
namespace {

// Work-groups that the gradient of the weights is cut into, whatever the device, so that this does
// not change the sums' order.
constexpr int wanted_groups = 512;
constexpr int depth = 16;  // terms that a tile sums at once

/// Tiles of 4096 values, as wide as they can be to divide the columns.
GpuTile gpu_tile(int columns) { return columns % 64 == 0 ? GpuTile{64, 64} : GpuTile{128, 32}; }

class GpuConv2d final : public Conv2d {
 public:
  GpuConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        out_tile_(gpu_tile(shape.out_channels)),
        in_tile_(gpu_tile(shape.in_channels)),
        packed_(runtime.allocate<float>(shape.weight_size())) {
    if (parameters.gradient.size() == 0) return;
    if (!shape.in_planes) packed_transposed_ = runtime.allocate<float>(shape.weight_size());
    plan_chunks();
    partial_ = runtime.allocate<float>(std::size_t(all_chunks()) * sums() * shape.out_channels);
  }

  Launches prepare() override {
    Launches launches{Launch(kernel("forward", "pack", out_tile_),
                             range(shape_.out_channels, terms()), parameters_.values,
                             parameters_.weight_at, packed_)};
    if (packed_transposed_.size() > 0)
      launches.push_back(Launch(kernel("data", "pack_transposed", in_tile_),
                                range(shape_.in_channels, shape_.out_channels, shape_.taps()),
                                parameters_.values, parameters_.weight_at, packed_transposed_));
    return launches;
  }

  Launches forward(const Conv2dImages& part) override {
    const int pixels = part.images * area();
    return {Launch(kernel("forward", "forward", out_tile_),
                   range(ceil_div(pixels, out_tile_.rows), out_groups()), part.in, packed_,
                   parameters_.values, parameters_.bias_at, part.out, part.images)
                .with_local_size(out_tile_.items())
                .with_cost(conv2d_cost(shape_, part.images))
                .with_purpose(Purpose::forward)};
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
    const int wanted = ceil_div(wanted_groups, ceil_div(sums(), out_tile_.rows) * out_groups());
    chunk_pixels_ = round_up(ceil_div(pixels, wanted), depth);
    chunks_ = ceil_div(pixels, chunk_pixels_);
  }

  Launch sum_weights(const Conv2dImages& part, bool first) {
    return Launch(kernel("weights", "weights", out_tile_),
                  range(ceil_div(sums(), out_tile_.rows), out_groups(), chunks_), part.in,
                  part.grad_out, partial_, part.images, chunk_pixels_, part.sums * chunks_,
                  first ? 1 : 0)
        .with_local_size(out_tile_.items())
        .with_cost(conv2d_cost(shape_, part.images))
        .with_purpose(Purpose::weight_gradient);
  }

  Launch backward_data(const Conv2dImages& part) {
    return Launch(kernel("data", "data", in_tile_),
                  range(ceil_div(part.images * area(), in_tile_.rows),
                        shape_.in_channels / in_tile_.columns, shape_.stride * shape_.stride),
                  part.grad_out, packed_transposed_, part.in, part.grad_in, part.images)
        .with_local_size(in_tile_.items())
        .with_cost(conv2d_cost(shape_, part.images))
        .with_purpose(Purpose::data_gradient);
  }

  Kernel kernel(const std::string& pass, const std::string& name, const GpuTile& tile) {
    auto defines = pass == "forward" ? conv2d_forward_defines(shape_) : conv2d_defines(shape_);
    tile.define(defines);
    return runtime_.kernel({"common.clh", "gpu_tile.clh", "conv2d.clh", "conv2d_gpu.clh",
                            "conv2d_gpu_" + pass + ".cl"},
                           "conv2d_gpu_" + name, defines);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  GpuTile out_tile_, in_tile_;
  int chunk_pixels_ = 0, chunks_ = 0;
  Buffer<float> packed_, packed_transposed_, partial_;
};

}  // namespace

std::unique_ptr<Conv2d> make_conv2d_gpu(Runtime& runtime, const Conv2dShape& shape,
                                        const Conv2dParameters& parameters) {
  return std::make_unique<GpuConv2d>(runtime, shape, parameters);
}

}  // namespace touchtrace
