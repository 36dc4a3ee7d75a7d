#include <algorithm>
#include <numeric>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

constexpr int points = 81, weight_sets = 36;
// Limit of local memory per work-group: leaves room for the weights in the second-level cache, and
// divides a micro-batch of 32 images evenly among cores.
constexpr std::size_t max_group_bytes = 512 * 1024;

int tiles_of(const Conv2dShape& shape) {
  return ceil_div(shape.out_rows(), 4) * ceil_div(shape.out_cols(), 4);
}

/// Images whose transforms fit into `bytes` of local memory.
int images_in(std::size_t bytes, const Conv2dShape& shape) {
  const std::size_t channels = shape.in_channels + shape.out_channels;
  const std::size_t image = sizeof(float) * points * tiles_of(shape) * channels;
  const std::size_t padding = sizeof(float) * points * 2 * 16;
  if (bytes < padding) return 0;
  return static_cast<int>(std::min<std::size_t>(shape.images, (bytes - padding) / image));
}

class WinogradConv2d final : public Conv2d {
 public:
  WinogradConv2d(Runtime& runtime, const Conv2dShape& shape, const Conv2dParameters& parameters)
      : runtime_(runtime),
        shape_(shape),
        parameters_(parameters),
        group_(winograd_group(runtime, shape)),
        weights_(runtime.allocate<float>(sets_size())),
        weight_gradient_(runtime, shape, parameters) {
    if (parameters.gradient.size() > 0) weights_transposed_ = runtime.allocate<float>(sets_size());
  }

  Launches prepare() override {
    const int in = shape_.in_channels, out = shape_.out_channels, taps = shape_.taps();
    Launches launches{transform(in, taps, out, taps * in, weights_)};
    if (weights_transposed_.size() > 0)
      launches.push_back(transform(out, taps * in, in, taps, weights_transposed_));
    return launches;
  }

  Launches forward(const Conv2dMicroBatch& batch) override {
    return {Launch(kernel("forward", conv2d_forward_defines(shape_)), groups(batch), batch.in,
                   weights_, parameters_.values, parameters_.bias_at, batch.out, batch.num_images)
                .with_local_size(1)  // a work-item has the work-group's local memory to itself
                .with_cost(cost(batch))
                .with_purpose(Purpose::forward)};
  }

  Launches backward(const Conv2dMicroBatch& batch, bool is_first) override {
    Launches launches{weight_gradient_.sum(batch, is_first)};
    if (batch.grad_in.size() > 0)
      launches.push_back(Launch(kernel("backward_data", conv2d_defines(shape_)), groups(batch),
                                batch.grad_out, weights_transposed_, batch.in, batch.grad_in,
                                batch.num_images)
                             .with_local_size(1)
                             .with_cost(cost(batch))
                             .with_purpose(Purpose::data_gradient));
    return launches;
  }

  Launches finish() override { return {weight_gradient_.finish()}; }

 private:
  std::size_t sets_size() const {
    return std::size_t(weight_sets) * shape_.in_channels * shape_.out_channels;
  }
  /// Operations of the matrix products; transforms are not counted.
  LaunchCost cost(const Conv2dMicroBatch& batch) const {
    return {2.0 * points * batch.num_images * tiles_of(shape_) * shape_.in_channels *
                shape_.out_channels,
            conv2d_cost(shape_, batch.num_images).bytes};
  }
  cl::NDRange groups(const Conv2dMicroBatch& batch) const {
    return range(ceil_div(batch.num_images, group_));
  }
  Kernel kernel(const std::string& pass, Defines defines) {
    defines["GROUP_IMAGES"] = std::to_string(group_);
    defines["TILE_MEMORY"] = "__local";
    return runtime_.kernel({"common.clh", "cpu_tile.clh", "conv2d.clh", "winograd.clh",
                            "winograd_weights.cl", "winograd_transform.clh", "winograd_passes.cl"},
                           "winograd_" + pass, defines);
  }
  /// Transforms the weights to sets [rows][lanes]; steps are the strides of the parameters.
  Launch transform(int rows, int row_step, int lanes, int lane_step, const Buffer<float>& to) {
    return Launch(kernel("weights", conv2d_forward_defines(shape_)), range(lanes / 16, rows),
                  parameters_.values, parameters_.weight_at, row_step, lane_step, to);
  }

  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  int group_;
  Buffer<float> weights_, weights_transposed_;
  Conv2dWeightGradient weight_gradient_;
};

}  // namespace

int winograd_group(const Runtime& runtime, const Conv2dShape& shape) {
  const std::size_t memory = runtime.device().handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  const int images = images_in(std::min(memory, max_group_bytes), shape);
  // Images that fill the matrix products' tiles of 4 rows.
  const int multiple = 4 / std::gcd(4, tiles_of(shape));
  return images < multiple ? images : images / multiple * multiple;
}

std::unique_ptr<Conv2d> make_conv2d_winograd(Runtime& runtime, const Conv2dShape& shape,
                                             const Conv2dParameters& parameters) {
  return std::make_unique<WinogradConv2d>(runtime, shape, parameters);
}

}  // namespace touchtrace
