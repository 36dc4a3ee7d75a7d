#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

// Minimum work of a work-item: starting a work-group of one item costs a CPU runtime about 200
// vector operations.
constexpr int min_vector_operations = 20000;
// Leaves 8 of the 32 vector registers of AVX-512 for operands.
constexpr int default_accumulators = 24;
constexpr int max_pixels = 12;  // per tile: conv2d_tile.clh names this many accumulators

/// One of the two passes that multiply tiles. SIMD lanes are output channels in the forward pass
/// and input channels in the input gradient.
struct TiledPass {
  const char* file;
  Defines (*defines)(const Conv2dShape&);
  int lanes, channels, lane_stride, channel_stride;
  int classes;       ///< parity classes of input pixels, which have different taps
  int accumulators;  ///< vectors of 16 floats per tile

  /// Blocks of 16 lanes per tile. More blocks take fewer loads per multiplication; more pixels take
  /// fewer weights from the second-level cache.
  int blocks() const { return classes > 1 ? 1 : lanes % 64 == 0 ? 4 : 2; }
  /// Output pixels per tile.
  int pixels() const { return std::clamp(accumulators / classes / blocks(), 1, max_pixels); }
  int groups() const { return lanes / 16 / blocks(); }
};

int accumulators_of(const Conv2dChoice& choice) {
  return choice.accumulators > 0 ? choice.accumulators : default_accumulators;
}

TiledPass forward_pass(const Conv2dShape& s, const Conv2dChoice& choice) {
  return {"conv2d_forward.cl",
          conv2d_forward_defines,
          s.out_channels,
          s.in_channels,
          s.in_channels * s.taps(),
          s.taps(),
          1,
          accumulators_of(choice)};
}

TiledPass data_pass(const Conv2dShape& s, const Conv2dChoice& choice) {
  return {"conv2d_backward_data.cl",
          conv2d_defines,
          s.in_channels,
          s.out_channels,
          s.taps(),
          s.in_channels * s.taps(),
          s.stride * s.stride,
          accumulators_of(choice)};
}

Kernel tiled_kernel(Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass,
                    const std::string& name, const char* more = nullptr) {
  auto defines = pass.defines(shape);
  defines["BLOCKS"] = std::to_string(pass.blocks());
  defines["PIXELS"] = std::to_string(pass.pixels());
  std::vector<std::string> files{"common.clh", "conv2d.clh", "conv2d_pack.cl", "conv2d_tile.clh",
                                 pass.file};
  if (more) files.emplace_back(more);
  return runtime.kernel(files, name, defines);
}

/// Tiles per work-item.
int tiles_per_item(const Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass,
                   const Conv2dChoice& choice) {
  if (choice.item_tiles > 0) return choice.item_tiles;
  const int operations = pass.channels * shape.taps() * pass.pixels() * pass.blocks();
  return runtime.device().type == "cpu" ? ceil_div(min_vector_operations, operations) : 1;
}

class DirectConv2d final : public Conv2d {
 public:
  DirectConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters,
               const Conv2dChoice& choice)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        choice_(choice),
        packed_(runtime.allocate<float>(shape.weight_size())),
        weight_gradient_(runtime, shape, parameters, choice) {
    if (parameters.gradient.size() > 0 && !shape.in_planes)
      packed_transposed_ = runtime.allocate<float>(shape.weight_size());
  }

  Launches prepare() override {
    Launches launches{pack(forward_pass(shape_, choice_), packed_)};
    if (packed_transposed_.size() > 0)
      launches.push_back(pack(data_pass(shape_, choice_), packed_transposed_));
    return launches;
  }

  Launches forward(const Conv2dMicroBatch& batch) override {
    const auto pass = forward_pass(shape_, choice_);
    return {Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_forward"),
                   range(items(pass, batch), pass.groups()), batch.in, packed_, parameters_.values,
                   parameters_.bias_at, batch.out, batch.num_images,
                   tiles_per_item(runtime_, shape_, pass, choice_))
                .with_cost(conv2d_cost(shape_, batch.num_images))
                .with_purpose(Purpose::forward)};
  }

  Conv2dHalves forward_halves(const Conv2dMicroBatch& batch, int channel) override {
    // Two launches cannot share compensation terms, so Accuracy::exact uses one.
    if (!shape_.in_planes || runtime_.accuracy() == Accuracy::exact)
      return Conv2d::forward_halves(batch, channel);
    const auto pass = forward_pass(shape_, choice_);
    const auto kernel = [&](const char* name) {
      return tiled_kernel(runtime_, shape_, pass, name, "conv2d_halves.cl");
    };
    const auto size = range(items(pass, batch), pass.groups());
    const int tiles = tiles_per_item(runtime_, shape_, pass, choice_);
    const auto sums = runtime_.allocate<float>(batch.out.size());
    return {{Launch(kernel("conv2d_first_half"), size, batch.in, packed_, parameters_.values,
                    parameters_.bias_at, sums, batch.num_images, tiles, channel)
                 .with_purpose(Purpose::forward)},
            {Launch(kernel("conv2d_second_half"), size, batch.in, packed_, sums, batch.out,
                    batch.num_images, tiles, channel)
                 .with_purpose(Purpose::forward)}};
  }

  Launches backward(const Conv2dMicroBatch& batch, bool is_first) override {
    Launches launches{weight_gradient_.sum(batch, is_first)};
    if (batch.grad_in.size() == 0) return launches;
    const auto pass = data_pass(shape_, choice_);
    launches.push_back(Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_backward_data"),
                              range(items(pass, batch), pass.groups()), batch.grad_out,
                              packed_transposed_, batch.in, batch.grad_in, batch.num_images,
                              tiles_per_item(runtime_, shape_, pass, choice_))
                           .with_cost(conv2d_cost(shape_, batch.num_images))
                           .with_purpose(Purpose::data_gradient));
    return launches;
  }

  Launches finish() override { return {weight_gradient_.finish()}; }

 private:
  int items(const TiledPass& pass, const Conv2dMicroBatch& batch) const {
    const int pixels = batch.num_images * shape_.out_rows() * shape_.out_cols();
    return ceil_div(ceil_div(pixels, pass.pixels()),
                    tiles_per_item(runtime_, shape_, pass, choice_));
  }
  Launch pack(const TiledPass& pass, const Buffer<float>& packed) {
    return Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_pack"),
                  range(pass.channels, pass.groups()), parameters_.values, parameters_.weight_at,
                  pass.lane_stride, pass.channel_stride, packed);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  Conv2dChoice choice_;
  Buffer<float> packed_, packed_transposed_;
  Conv2dWeightGradient weight_gradient_;
};

}  // namespace

std::vector<Conv2dChoice> direct_candidates() {
  // 12 accumulators suit processors with 16 vector registers.
  std::vector<Conv2dChoice> candidates(5);
  candidates[1].accumulators = 12;
  candidates[2].accumulators = 28;
  candidates[3].item_tiles = 1;
  candidates[4].item_tiles = 8;
  return candidates;
}

std::unique_ptr<Conv2d> make_conv2d_direct(Runtime& runtime, const Conv2dShape& shape,
                                           const Conv2dParameters& parameters,
                                           const Conv2dChoice& choice) {
  return std::make_unique<DirectConv2d>(runtime, shape, parameters, choice);
}

}  // namespace touchtrace
