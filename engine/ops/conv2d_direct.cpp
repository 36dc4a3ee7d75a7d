#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

// How much work an item should do at least, since a work-group of one item costs a CPU runtime
// about as much as 200 vector operations.
constexpr int wanted_vector_operations = 20000;
// Of the 32 vector registers of AVX-512.
constexpr int usual_accumulators = 24;
constexpr int most_pixels = 12;  // of a tile, as conv2d_tile.clh names them

/// One of the two passes that multiply tiles: the forward pass, with output channels as lanes, or
/// the gradient towards the input, the other way round.
struct TiledPass {
  const char* file;
  Defines (*defines)(const Conv2dShape&);
  int lanes, channels, lane_stride, channel_stride;
  int classes;       ///< tiles that one place of the output takes: of input pixels by parity
  int accumulators;  ///< vectors of 16 values in a tile

  /// Of 16 lanes in a tile. Many blocks need few loads for a multiplication; many pixels need few
  /// weights from the second-level cache, of which several classes read as many as one.
  int blocks() const { return classes > 1 ? 1 : lanes % 64 == 0 ? 4 : 2; }
  /// Output pixels in a tile.
  int pixels() const { return std::clamp(accumulators / classes / blocks(), 1, most_pixels); }
  int groups() const { return lanes / 16 / blocks(); }
};

int accumulators_of(const Conv2dChoice& choice) {
  return choice.accumulators > 0 ? choice.accumulators : usual_accumulators;
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

/// Tiles that a work-item does one after the other.
int tiles_an_item(const Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass,
                  const Conv2dChoice& choice) {
  if (choice.item_tiles > 0) return choice.item_tiles;
  const int operations = pass.channels * shape.taps() * pass.pixels() * pass.blocks();
  return runtime.device().type == "cpu" ? ceil_div(wanted_vector_operations, operations) : 1;
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
        weights_gradient_(runtime, shape, parameters, choice) {
    if (parameters.gradient.size() > 0 && !shape.in_planes)
      packed_transposed_ = runtime.allocate<float>(shape.weight_size());
  }

  Launches prepare() override {
    Launches launches{pack(forward_pass(shape_, choice_), packed_)};
    if (packed_transposed_.size() > 0)
      launches.push_back(pack(data_pass(shape_, choice_), packed_transposed_));
    return launches;
  }

  Launches forward(const Conv2dImages& part) override {
    const auto pass = forward_pass(shape_, choice_);
    return {Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_forward"),
                   range(items(pass, part), pass.groups()), part.in, packed_, parameters_.values,
                   parameters_.bias_at, part.out, part.images,
                   tiles_an_item(runtime_, shape_, pass, choice_))
                .with_cost(conv2d_cost(shape_, part.images))
                .with_purpose(Purpose::forward)};
  }

  Conv2dHalves forward_halves(const Conv2dImages& part, int channel) override {
    // Two launches cannot share compensations, so Accuracy::exact sums in one.
    if (!shape_.in_planes || runtime_.accuracy() == Accuracy::exact)
      return Conv2d::forward_halves(part, channel);
    const auto pass = forward_pass(shape_, choice_);
    const auto kernel = [&](const char* name) {
      return tiled_kernel(runtime_, shape_, pass, name, "conv2d_halves.cl");
    };
    const auto size = range(items(pass, part), pass.groups());
    const int tiles = tiles_an_item(runtime_, shape_, pass, choice_);
    const auto sums = runtime_.allocate<float>(part.out.size());
    return {{Launch(kernel("conv2d_first_half"), size, part.in, packed_, parameters_.values,
                    parameters_.bias_at, sums, part.images, tiles, channel)
                 .with_purpose(Purpose::forward)},
            {Launch(kernel("conv2d_second_half"), size, part.in, packed_, sums, part.out,
                    part.images, tiles, channel)
                 .with_purpose(Purpose::forward)}};
  }

  Launches backward(const Conv2dImages& part, bool first) override {
    Launches launches{weights_gradient_.sum(part, first)};
    if (part.grad_in.size() == 0) return launches;
    const auto pass = data_pass(shape_, choice_);
    launches.push_back(Launch(tiled_kernel(runtime_, shape_, pass, "conv2d_backward_data"),
                              range(items(pass, part), pass.groups()), part.grad_out,
                              packed_transposed_, part.in, part.grad_in, part.images,
                              tiles_an_item(runtime_, shape_, pass, choice_))
                           .with_cost(conv2d_cost(shape_, part.images))
                           .with_purpose(Purpose::data_gradient));
    return launches;
  }

  Launches finish() override { return {weights_gradient_.finish()}; }

 private:
  int items(const TiledPass& pass, const Conv2dImages& part) const {
    const int pixels = part.images * shape_.out_rows() * shape_.out_cols();
    return ceil_div(ceil_div(pixels, pass.pixels()),
                    tiles_an_item(runtime_, shape_, pass, choice_));
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
  Conv2dWeightsGradient weights_gradient_;
};

}  // namespace

std::vector<Conv2dChoice> direct_candidates() {
  // 12 for processors with 16 vector registers.
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
