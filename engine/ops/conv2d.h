#pragma once

#include <cstddef>

#include "engine/cl/launch.h"

namespace touchtrace {

/// A convolution 3x3 of stride 2 and padding 1 with bias and ReLU over `images` images:
///
///     out[k][y][x] = max(0, bias[k] + sum_{c, i, j} weight[k][c][i][j] in[c][2y + i - 1][2x + j -
///     1])
///
/// Device arrays have the layouts of kernels/conv2d.clh: blocks of 16 channels with a halo of one
/// zero pixel; the halo is the caller's to zero, once, and kernels never write it. Input in blocks
/// is the output of a ReLU with a multiple of 32 channels; input in planes has any number of
/// channels and gets no gradient. `out_channels` is a multiple of 32.
struct Conv2dShape {
  int images, in_channels, rows, cols, out_channels;
  bool in_planes;

  int out_rows() const { return (rows + 1) / 2; }
  int out_cols() const { return (cols + 1) / 2; }
  std::size_t in_size() const;   ///< floats of the input with its halo
  std::size_t out_size() const;  ///< floats of the output with its halo
  /// Of one forward pass or of one of the two backward passes, taps in the halo included.
  double flops() const;
};

/// Where a layer's weight [out, in, 3, 3] and bias [out] start in the flat buffer of parameters.
struct Conv2dPlaces {
  int weight_at, bias_at;
};

/// Each pass holds its launches, bound to fixed arrays; `parameters` and `gradient` are flat.
class Conv2dForward {
 public:
  Conv2dForward(Runtime& runtime, const Conv2dShape& shape, Conv2dPlaces places,
                const Buffer<float>& in, const Buffer<float>& out);
  void enqueue(Runtime& runtime, const Buffer<float>& parameters);

 private:
  Buffer<float> packed_;
  Launch pack_, convolve_;
};

/// grad_in from grad_out, both without what the ReLU of their array blocks; `in` gives that of
/// grad_in.
class Conv2dBackwardData {
 public:
  Conv2dBackwardData(Runtime& runtime, const Conv2dShape& shape, Conv2dPlaces places,
                     const Buffer<float>& in, const Buffer<float>& grad_out,
                     const Buffer<float>& grad_in);
  void enqueue(Runtime& runtime, const Buffer<float>& parameters);

 private:
  Buffer<float> packed_;
  Launch pack_, gather_;
};

/// How the weight gradient's sum over images is cut, which decides its rounding.
struct Conv2dChunks {
  int count, images;  ///< images in a chunk; the last may hold fewer
};

/// Adds the gradients of weight and bias, summed in an order that depends on the shape only.
class Conv2dBackwardWeights {
 public:
  Conv2dBackwardWeights(Runtime& runtime, const Conv2dShape& shape, Conv2dPlaces places,
                        const Buffer<float>& in, const Buffer<float>& grad_out);
  void enqueue(Runtime& runtime, const Buffer<float>& gradient);

 private:
  Conv2dChunks chunks_;
  Buffer<float> partial_, partial_bias_;
  Launch sum_, reduce_;
};

}  // namespace touchtrace
