#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/integer_math.h"
#include "engine/cl/launch.h"
#include "engine/ops/conv2d_choice.h"

namespace touchtrace {

/// A convolution with bias and ReLU over images, of kernel 3 or 5 and stride 1 or 2, padded by half
/// the kernel:
///
///     out[k][y][x] = max(0, bias[k] + sum_{c, i, j} weight[k][c][i][j] in[c][row][column]),
///     row = stride y + i - padding,  column = stride x + j - padding
///
/// Device arrays have the layouts of kernels/conv2d.clh: blocks of 16 channels. Input and output
/// have a halo of as many zero pixels as the padding, which is the caller's to zero, once, and
/// which kernels never write; so layers that share an array have the same kernel. Input in blocks
/// is the output of a ReLU with a multiple of 32 channels; input in planes has any number of
/// channels and gets no gradient. `out_channels` is a multiple of 32.
struct Conv2dShape {
  int images, in_channels, rows, cols, out_channels;
  bool in_planes;
  int kernel = 3, stride = 2;
  /// Output pixels, counted along rows, whose taps read nothing but zeros in every image, in
  /// ascending order. The direct method does not compute them.
  std::vector<int> dead = {};
  /// No halo around the output, as a dense layer wants it; its gradient has one even so.
  bool compact_output = false;

  int taps() const { return kernel * kernel; }
  int halo() const { return kernel / 2; }
  int out_halo() const { return compact_output ? 0 : halo(); }
  int out_rows() const { return ceil_div(rows, stride); }
  int out_cols() const { return ceil_div(cols, stride); }
  std::size_t in_size() const;        ///< floats of the input with its halo
  std::size_t out_size() const;       ///< floats of the output with its halo, if it has one
  std::size_t grad_out_size() const;  ///< floats of the output's gradient with its halo
  std::size_t weight_size() const { return std::size_t(out_channels) * in_channels * taps(); }
  /// Of one forward pass or of one of the two backward passes, taps in the halo included and dead
  /// pixels left out, whatever the method.
  double flops() const;
};

/// Conv2dShape::dead where the input is zero in every image but for the pixels [rows, cols] that
/// `live` holds 1 for.
std::vector<int> dead_pixels(const Conv2dShape& shape, const std::vector<std::uint8_t>& live);

/// The flat buffers of all parameters and of their gradient (empty: no backward pass), and where a
/// layer's weight [out, in, kernel, kernel] and bias [out] start in them.
struct Conv2dParameters {
  Buffer<float> values, gradient;
  int weight_at, bias_at;
  int sums = 1;  ///< sets of sums behind the gradient, 1 or 2
};

/// The arrays of some of a layer's images. Gradients are without what the ReLU of their array
/// blocks: `in` gives that of grad_in. Empty `grad_in`: no gradient towards the input.
struct Conv2dImages {
  int images;
  Buffer<float> in, out, grad_out, grad_in;
  /// Which set of the layer's sums the weights' gradient goes to: parts that run beside each other
  /// have sums of their own.
  int sums = 0;
};

/// Launches of a pass, the second half's to be queued after the first's.
struct Conv2dHalves {
  Launches first, second;
};

/// A layer, planned once; its passes may be cut into parts of the images, so that what a part
/// writes is still in the cache when it is read. `shape.images` is the largest part's. A part's
/// launches are bound to the layer, which must outlive them, and share its scratch memory.
class Conv2d {
 public:
  virtual ~Conv2d() = default;

  virtual Launches prepare() = 0;  ///< once after the weights changed
  virtual Launches forward(const Conv2dImages& part) = 0;
  /// forward(), to the same bits, in two halves: the first needs input channels before `channel`
  /// only and leaves their sums to the second. A method that cannot leaves all to the second.
  virtual Conv2dHalves forward_halves(const Conv2dImages& part, int channel) {
    static_cast<void>(channel);
    return {{}, forward(part)};
  }
  /// The gradient towards the input, and the weights' into the part's set of the layer's sums: the
  /// `first` part of a set starts it, others add to it.
  virtual Launches backward(const Conv2dImages& part, bool first) = 0;
  /// After the last part: adds the gradients of weight and bias. Every sum has one fixed order.
  virtual Launches finish() = 0;
};

/// The method that needs fewer multiplications, those beyond the image's edge counted too.
Conv2dMethod best_method(const Conv2dShape& shape);

std::unique_ptr<Conv2d> make_conv2d(Runtime& runtime, const Conv2dShape& shape,
                                    const Conv2dParameters& parameters, const Conv2dChoice& choice);

}  // namespace touchtrace
