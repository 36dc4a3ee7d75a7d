#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/cl/runtime.h"
#include "engine/model/weights.h"
#include "engine/ops/channel_blocks.h"
#include "engine/ops/conv2d.h"
#include "engine/ops/tactile_window.h"
#include "engine/ops/tuning.h"

namespace touchtrace {

/// [rows, cols]: 0 for taxels that are zero in every frame, else 1; empty where that is not known.
using LiveTaxels = std::vector<std::uint8_t>;

/// Of a stream [frames, taxels].
LiveTaxels live_taxels(std::span<const float> stream, std::size_t taxels);

/// Windows of touch, and three convolutions over them with 32, 64 and 128 channels. The paper's
/// (section III-B) have kernels of 3 and strides of 2.
struct TactileEncoderShape {
  TactileWindowShape windows;  ///< their halo follows from the kernel
  int kernel = 3;              ///< of all three: 3 or 5
  std::array<int, 3> strides{2, 2, 2};
  LiveTaxels live = {};

  /// The first one leaves out its dead pixels where that pays. Throws usage_error for frames
  /// outside 6..64 or M outside 1..32.
  std::array<Conv2dShape, 3> layers() const;
  /// The same over another number of windows.
  TactileEncoderShape of_windows(int count) const;
  /// What the last one gives.
  ChannelBlocksShape features() const;
};

/// The convolutional half of the tactile and of the object encoder: convolutions, each with bias
/// and ReLU, over the window of M frames in the difference basis of tactile_window.h.
///
/// Windows are never copied by the host: they are places in the stream of frames. All work is
/// queued; nothing blocks.
class TactileEncoder {
 public:
  /// Windows that go through all layers together, so that what one layer writes is still in the
  /// cache when the next one reads it; unless another number was tuned.
  static constexpr int part_windows = 32;

  /// Adds "NAME.conv1.weight" [32, M, kernel, kernel], "NAME.conv1.bias" [32], ... to `table`,
  /// started as PyTorch starts convolutions (uniform within 1/sqrt(fan in)).
  static void declare(const std::string& name, const TactileEncoderShape& shape,
                      ParameterTable& table);

  /// How a layer is computed in training where nothing was tuned.
  static Conv2dChoice usual_choice(const Conv2dShape& layer);

  /// There is a backward pass if `weights` has a gradient; only then `tuning` counts, since the
  /// number of windows must not change a bit of a prediction.
  TactileEncoder(Runtime& runtime, const std::string& name, const TactileEncoderShape& shape,
                 const Weights& weights, const Tuning& tuning = {});
  ~TactileEncoder();

  /// In the rows of channel_blocks.h; valid after forward().
  const Buffer<float>& features() const;
  /// The same of their gradient: given to backward().
  const Buffer<float>& grad_features() const;

  void prepare();  ///< once after the weights changed
  /// `stream`: [frames, rows, cols]. `last_frame`: [windows]; window w holds the frames
  /// last_frame[w] - M + 1 .. last_frame[w], which must lie in the stream.
  void forward(const Buffer<float>& stream, const Buffer<int>& last_frame,
               const TaxelDropout& dropout = {});
  /// forward() of a single window, for prediction, in two halves and to the same bits: what its
  /// last frame does not change, which need not be in the stream yet, then the rest.
  void forward_early(const Buffer<float>& stream, const Buffer<int>& last_frame);
  void forward_late(const Buffer<float>& stream, const Buffer<int>& last_frame);
  /// Adds the gradients of the last forward pass's weights and biases to the weights' gradient,
  /// zeroed by the caller; sums have one fixed order.
  void backward();

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace touchtrace
