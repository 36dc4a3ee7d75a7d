#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/integer_math.h"
#include "engine/cl/launch.h"

namespace touchtrace {

/// Convolution with bias and ReLU, kernel size 3 or 5, stride 1 or 2, padding kernel / 2:
///
///     out[k][y][x] = max(0, bias[k] + sum_{c, i, j} weight[k][c][i][j] in[c][row][column]),
///     row = stride y + i - padding,  column = stride x + j - padding
///
/// Layouts: kernels/conv2d.clh. Input and output have a halo of zero pixels as wide as the padding.
/// The caller zeroes halos once; kernels never write them. Layers that share an array must have the
/// same kernel size. Input is either the output of a ReLU in blocks of 16 channels, a multiple of
/// 32 of them, or planes of any number of channels, which get no gradient. `out_channels` is a
/// multiple of 32.
struct Conv2dShape {
  int images, in_channels, rows, cols, out_channels;
  bool in_planes;
  int kernel = 3, stride = 2;
  /// Indices (row * out_cols + column, ascending) of output pixels whose taps read only zeros in
  /// every image. The direct method skips them.
  std::vector<int> dead = {};
  /// Output without halo, for a dense layer. Its gradient has a halo.
  bool compact_output = false;

  int taps() const { return kernel * kernel; }
  int halo() const { return kernel / 2; }
  int out_halo() const { return compact_output ? 0 : halo(); }
  int out_rows() const { return ceil_div(rows, stride); }
  int out_cols() const { return ceil_div(cols, stride); }
  std::size_t in_size() const;        ///< number of floats of the input, halo included
  std::size_t out_size() const;       ///< number of floats of the output, halo included
  std::size_t grad_out_size() const;  ///< number of floats of the output gradient, halo included
  std::size_t weight_size() const { return std::size_t(out_channels) * in_channels * taps(); }
  /// Operations of one forward pass, input gradient or weight gradient by the direct method: taps
  /// in the halo included, dead pixels excluded.
  double flops() const;
};

/// Conv2dShape::dead for inputs that are zero where `live` [rows, cols] is 0.
std::vector<int> dead_pixels(const Conv2dShape& shape, const std::vector<std::uint8_t>& live);

/// Flat buffers of all parameters and their gradient, with the offsets of a layer's weight
/// [out, in, kernel, kernel] and bias [out]. Empty `gradient`: no backward pass.
struct Conv2dParameters {
  Buffer<float> values, gradient;
  int weight_at, bias_at;
  int num_accumulators = 1;  ///< partial weight gradients, 1 or 2
};

/// Device arrays of a micro-batch (layouts: kernels/conv2d.clh). Gradients are with respect to
/// pre-activations.
struct Conv2dMicroBatch {
  int num_images;  ///< at most Conv2dShape::images
  Buffer<float> in, out;
  Buffer<float> grad_out;  ///< read by backward()
  Buffer<float> grad_in;   ///< written by backward(), 0 where in <= 0; empty: not computed
  int accumulator = 0;     ///< partial weight gradient; not shared between concurrent queues
};

/// A convolution layer. Passes run on micro-batches, so that the output of a layer is still in the
/// cache when the next one reads it. Launches share the layer's scratch memory; the layer must
/// outlive them.
class Conv2d {
 public:
  virtual ~Conv2d() = default;

  /// Packs the weights. Enqueue after each change of the parameters.
  virtual Launches prepare() = 0;
  virtual Launches forward(const Conv2dMicroBatch& batch) = 0;
  /// Computes grad_in; adds the weight gradient to batch.accumulator, or overwrites it if
  /// `is_first`.
  virtual Launches backward(const Conv2dMicroBatch& batch, bool is_first) = 0;
  /// Adds all accumulators to Conv2dParameters::gradient, in an order independent of threads.
  /// Enqueue after the last backward().
  virtual Launches finish() = 0;
};

/// Algorithm of the forward pass and the input gradient. `winograd` takes 81 multiplications
/// instead of 144 (kernels/winograd.clh). It needs kernel 3, stride 2, input in blocks, local
/// memory for the transform of one image, and Accuracy::fast; otherwise `direct` is used.
enum class Conv2dMethod { direct, winograd };

/// The method that takes fewer multiplications, padding included.
Conv2dMethod best_method(const Conv2dShape& shape);

/// Layer with `method`. With KernelVariant::gpu that has no effect.
std::unique_ptr<Conv2d> make_conv2d(Runtime& runtime, const Conv2dShape& shape,
                                    const Conv2dParameters& parameters, Conv2dMethod method);

}  // namespace touchtrace
