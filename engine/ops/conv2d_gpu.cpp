#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"
#include "engine/ops/gpu_tile.h"

namespace touchtrace {
namespace {

// Minimum number of work-groups of the weight gradient. Independent of the device, so that the
// order of sums is, too.
constexpr int min_groups = 512;
constexpr int depth = 16;  // terms per step of a tile

/// Tile of 4096 values, with the greatest width that divides the columns.
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

  Launches forward(const Conv2dMicroBatch& batch) override {
    const int pixels = batch.num_images * area();
    return {Launch(kernel("forward", "forward", out_tile_),
                   range(ceil_div(pixels, out_tile_.rows), out_groups()), batch.in, packed_,
                   parameters_.values, parameters_.bias_at, batch.out, batch.num_images)
                .with_local_size(out_tile_.items())
                .with_cost(conv2d_cost(shape_, batch.num_images))
                .with_purpose(Purpose::forward)};
  }

  Launches backward(const Conv2dMicroBatch& batch, bool is_first) override {
    Launches launches{sum_weights(batch, is_first)};
    if (batch.grad_in.size() > 0) launches.push_back(backward_data(batch));
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
  int sums() const { return terms() + 1; }  ///< weight and bias gradients per output channel
  int all_chunks() const { return parameters_.num_accumulators * chunks_; }
  int out_groups() const { return shape_.out_channels / out_tile_.columns; }

  /// Number of classes of input pixels in `conv2d_gpu_data` that have pixels.
  int classes() const {
    return std::min(shape_.stride, shape_.rows) * std::min(shape_.stride, shape_.cols);
  }

  void plan_chunks() {
    const int pixels = shape_.images * area();
    const int wanted = ceil_div(min_groups, ceil_div(sums(), out_tile_.rows) * out_groups());
    chunk_pixels_ = round_up(ceil_div(pixels, wanted), depth);
    chunks_ = ceil_div(pixels, chunk_pixels_);
  }

  Launch sum_weights(const Conv2dMicroBatch& batch, bool is_first) {
    return Launch(kernel("weights", "weights", out_tile_),
                  range(ceil_div(sums(), out_tile_.rows), out_groups(), chunks_), batch.in,
                  batch.grad_out, partial_, batch.num_images, chunk_pixels_,
                  batch.accumulator * chunks_, is_first ? 1 : 0)
        .with_local_size(out_tile_.items())
        .with_cost(conv2d_cost(shape_, batch.num_images))
        .with_purpose(Purpose::weight_gradient);
  }

  Launch backward_data(const Conv2dMicroBatch& batch) {
    return Launch(kernel("data", "data", in_tile_),
                  range(ceil_div(batch.num_images * area(), in_tile_.rows),
                        shape_.in_channels / in_tile_.columns, classes()),
                  batch.grad_out, packed_transposed_, batch.in, batch.grad_in, batch.num_images)
        .with_local_size(in_tile_.items())
        .with_cost(conv2d_cost(shape_, batch.num_images))
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
