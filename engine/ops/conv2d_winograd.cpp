#include <algorithm>
#include <numeric>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

constexpr int points = 81, weight_sets = 36;
// Of local memory, so that the weights find place in a second-level cache beside it, and that a
// part of 32 images becomes groups of equal size for the cores.
constexpr std::size_t largest_group_bytes = 512 * 1024;

int tiles_of(const Conv2dShape& shape) {
  return ceil_div(shape.out_rows(), 4) * ceil_div(shape.out_cols(), 4);
}

/// Images whose points this much local memory holds.
int images_in(std::size_t bytes, const Conv2dShape& shape) {
  const std::size_t channels = shape.in_channels + shape.out_channels;
  const std::size_t image = sizeof(float) * points * tiles_of(shape) * channels;
  const std::size_t padding = sizeof(float) * points * 2 * 16;
  if (bytes < padding) return 0;
  return static_cast<int>(std::min<std::size_t>(shape.images, (bytes - padding) / image));
}

class WinogradConv2d final : public Conv2d {
 public:
  WinogradConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters,
                 const Conv2dChoice& choice)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        group_(winograd_group(runtime, shape, choice)),
        weights_(runtime.allocate<float>(sets_size())),
        weights_gradient_(runtime, shape, parameters, choice) {
    if (parameters.gradient.size() > 0) weights_transposed_ = runtime.allocate<float>(sets_size());
  }

  Launches prepare() override {
    const int in = shape_.in_channels, out = shape_.out_channels, taps = shape_.taps();
    Launches launches{transform(in, taps, out, taps * in, weights_)};
    if (weights_transposed_.size() > 0)
      launches.push_back(transform(out, taps * in, in, taps, weights_transposed_));
    return launches;
  }

  Launches forward(const Conv2dImages& part) override {
    return {Launch(kernel("forward", conv2d_forward_defines(shape_)), groups(part), part.in,
                   weights_, parameters_.values, parameters_.bias_at, part.out, part.images)
                .with_local_size(1)  // a work-item has the work-group's local memory to itself
                .with_cost(cost(part))
                .with_purpose(Purpose::forward)};
  }

  Launches backward(const Conv2dImages& part, bool first) override {
    Launches launches{weights_gradient_.sum(part, first)};
    if (part.grad_in.size() > 0)
      launches.push_back(Launch(kernel("backward_data", conv2d_defines(shape_)), groups(part),
                                part.grad_out, weights_transposed_, part.in, part.grad_in,
                                part.images)
                             .with_local_size(1)
                             .with_cost(cost(part))
                             .with_purpose(Purpose::data_gradient));
    return launches;
  }

  Launches finish() override { return {weights_gradient_.finish()}; }

 private:
  std::size_t sets_size() const {
    return std::size_t(weight_sets) * shape_.in_channels * shape_.out_channels;
  }
  /// Multiplications and additions of the matrix products; those of the transforms are not counted.
  LaunchCost cost(const Conv2dImages& part) const {
    return {
        2.0 * points * part.images * tiles_of(shape_) * shape_.in_channels * shape_.out_channels,
        conv2d_cost(shape_, part.images).bytes};
  }
  cl::NDRange groups(const Conv2dImages& part) const {
    return range(ceil_div(part.images, group_));
  }
  Kernel kernel(const std::string& pass, Defines defines) {
    defines["GROUP_IMAGES"] = std::to_string(group_);
    defines["TILE_MEMORY"] = "__local";
    return runtime_.kernel({"common.clh", "cpu_tile.clh", "conv2d.clh", "winograd.clh",
                            "winograd_weights.cl", "winograd_transform.clh", "winograd_passes.cl"},
                           "winograd_" + pass, defines);
  }
  /// Sets [rows][lanes] of the parameters, in which a row's and a lane's weights stand `step`s
  /// apart.
  Launch transform(int rows, int row_step, int lanes, int lane_step, const Buffer<float>& to) {
    return Launch(kernel("weights", conv2d_forward_defines(shape_)), range(lanes / 16, rows),
                  parameters_.values, parameters_.weight_at, row_step, lane_step, to);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  int group_;
  Buffer<float> weights_, weights_transposed_;
  Conv2dWeightsGradient weights_gradient_;
};

}  // namespace

int winograd_group(const Runtime& runtime, const Conv2dShape& shape, const Conv2dChoice& choice) {
  const std::size_t memory = runtime.device().handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  if (choice.group_images > 0) return std::min(choice.group_images, images_in(memory, shape));
  const int images = images_in(std::min(memory, largest_group_bytes), shape);
  const int whole =
      4 / std::gcd(4, tiles_of(shape));  // images that fill the products' tiles of 4 rows
  return images < whole ? images : images / whole * whole;
}

std::vector<Conv2dChoice> winograd_candidates(const Runtime& runtime, const Conv2dShape& shape) {
  const Conv2dChoice usual{Conv2dMethod::winograd};
  std::vector<Conv2dChoice> candidates;
  if (!winograd_applies(shape) || runtime.accuracy() == Accuracy::exact) return candidates;
  const int group = winograd_group(runtime, shape, usual);
  if (group > 0) candidates.push_back(usual);
  for (const int images : {group / 4, group / 2, group * 2}) {
    auto candidate = usual;
    candidate.group_images = images;
    if (images > 0 && winograd_group(runtime, shape, candidate) == images)
      candidates.push_back(candidate);
  }
  return candidates;
}

std::unique_ptr<Conv2d> make_conv2d_winograd(Runtime& runtime, const Conv2dShape& shape,
                                             const Conv2dParameters& parameters,
                                             const Conv2dChoice& choice) {
  return std::make_unique<WinogradConv2d>(runtime, shape, parameters, choice);
}

}  // namespace touchtrace
