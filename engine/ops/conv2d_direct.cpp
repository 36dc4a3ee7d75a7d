#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

// Minimum work of a work-item: starting a work-group of one item costs a CPU runtime about 200
// vector operations.
constexpr int min_vector_operations = 20000;
// Of 16 floats per tile. Leaves 8 of the 32 vector registers of AVX-512 for operands.
constexpr int max_accumulators = 24;
constexpr int max_pixels = 12;  // per tile: conv2d_tile.clh names this many accumulators

/// One of the two passes that multiply tiles. SIMD lanes are output channels in the forward pass
/// and input channels in the input gradient.
struct TiledPass {
  const char* file;
  Defines (*defines)(const Conv2dShape&);
  int lanes, channels, lane_stride, channel_stride;
  int classes;  ///< parity classes of input pixels, which have different taps

  /// Blocks of 16 lanes per tile. More blocks take fewer loads per multiplication; more pixels take
  /// fewer weights from the second-level cache.
  int blocks() const { return classes > 1 ? 1 : lanes % 64 == 0 ? 4 : 2; }
  /// Output pixels per tile.
  int pixels() const { return std::clamp(max_accumulators / classes / blocks(), 1, max_pixels); }
  int groups() const { return lanes / 16 / blocks(); }
};

TiledPass forward_pass(const Conv2dShape& s) {
  return {"conv2d_forward.cl",
          conv2d_forward_defines,
          s.out_channels,
          s.in_channels,
          s.in_channels * s.taps(),
          s.taps(),
          1};
}

TiledPass data_pass(const Conv2dShape& s) {
  return {"conv2d_backward_data.cl", conv2d_defines,     s.in_channels, s.out_channels, s.taps(),
          s.in_channels * s.taps(),  s.stride * s.stride};
}

Kernel tiled_kernel(Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass,
                    const std::string& name) {
  auto defines = pass.defines(shape);
  defines["BLOCKS"] = std::to_string(pass.blocks());
  defines["PIXELS"] = std::to_string(pass.pixels());
  return runtime.kernel(
      {"common.clh", "conv2d.clh", "conv2d_pack.cl", "conv2d_tile.clh", pass.file}, name, defines);
}

/// Tiles per work-item.
int tiles_per_item(const Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass) {
  const int operations = pass.channels * shape.taps() * pass.pixels() * pass.blocks();
  return runtime.device().type == "cpu" ? ceil_div(min_vector_operations, operations) : 1;
}

class DirectConv2d final : public Conv2d {
 public:
  DirectConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        packed_(runtime.allocate<float>(shape.weight_size())),
        weight_gradient_(runtime, shape, parameters) {
    if (parameters.gradient.size() > 0 && !shape.in_planes)
      packed_transposed_ = runtime.allocate<float>(shape.weight_size());
  }

  Launches prepare() override {
    Launches launches{pack(forward_pass(shape_), packed_)};
    if (packed_transposed_.size() > 0)
      launches.push_back(pack(data_pass(shape_), packed_transposed_));
    return launches;
  }

  Launches forward(const Conv2dMicroBatch& batch) override {
    const auto pass = forward_pass(shape_);
    return {Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_forward"),
                   range(items(pass, batch), pass.groups()), batch.in, packed_, parameters_.values,
                   parameters_.bias_at, batch.out, batch.num_images,
                   tiles_per_item(runtime_, shape_, pass))
                .with_cost(conv2d_cost(shape_, batch.num_images))
                .with_purpose(Purpose::forward)};
  }

  Launches backward(const Conv2dMicroBatch& batch, bool is_first) override {
    Launches launches{weight_gradient_.sum(batch, is_first)};
    if (batch.grad_in.size() == 0) return launches;
    const auto pass = data_pass(shape_);
    launches.push_back(Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_backward_data"),
                              range(items(pass, batch), pass.groups()), batch.grad_out,
                              packed_transposed_, batch.in, batch.grad_in, batch.num_images,
                              tiles_per_item(runtime_, shape_, pass))
                           .with_cost(conv2d_cost(shape_, batch.num_images))
                           .with_purpose(Purpose::data_gradient));
    return launches;
  }

  Launches finish() override { return {weight_gradient_.finish()}; }

 private:
  int items(const TiledPass& pass, const Conv2dMicroBatch& batch) const {
    const int pixels = batch.num_images * shape_.out_rows() * shape_.out_cols();
    return ceil_div(ceil_div(pixels, pass.pixels()), tiles_per_item(runtime_, shape_, pass));
  }
  Launch pack(const TiledPass& pass, const Buffer<float>& packed) {
    return Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_pack"),
                  range(pass.channels, pass.groups()), parameters_.values, parameters_.weight_at,
                  pass.lane_stride, pass.channel_stride, packed);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  Buffer<float> packed_, packed_transposed_;
  Conv2dWeightGradient weight_gradient_;
};

}  // namespace

std::unique_ptr<Conv2d> make_conv2d_direct(Runtime& runtime, const Conv2dShape& shape,
                                           const Conv2dParameters& parameters) {
  return std::make_unique<DirectConv2d>(runtime, shape, parameters);
}

}  // namespace touchtrace
