#pragma once

#include <cstdint>

#include "engine/cl/launch.h"

namespace touchtrace {

/// Blanks a share of the taxels, the same ones in all frames of a window, and divides the others by
/// 1 - share. Which ones follows from a hash of (key, window, taxel); draw a new key every update.
struct TaxelDropout {
  double share = 0.0;  ///< in [0, 1); 0: nothing is blanked
  std::uint32_t key = 0;

  /// A taxel is blanked if its hash is below this.
  std::uint32_t threshold() const;
};

struct TactileWindowShape {
  int windows, frames, rows, cols;  ///< `frames`: M, of a window
  int halo = 1;                     ///< of the output

  std::size_t out_size() const;  ///< floats of the output with its halo
};

/// Windows of a stream of frames [frame][row][column] in the difference basis, in planes with a
/// halo of zero pixels (kernels/conv2d.clh; the halo is the caller's to zero):
///
///     out[w] = keep[w] [5 (T_{t-M+2} - T_{t-M+1}), ..., 5 (T_t - T_{t-1}), T_t],  t =
///     last_frame[w]
class TactileWindow {
 public:
  /// Of the windows first .. first + shape.windows - 1.
  TactileWindow(Runtime& runtime, const TactileWindowShape& shape, const Buffer<float>& out,
                int first = 0);
  /// `last_frame`: of all windows. Frames last_frame[w] - M + 1 .. last_frame[w] must lie in
  /// `stream`.
  /// Channels before `channel` stay as they are.
  void enqueue(Runtime& runtime, const Buffer<float>& stream, const Buffer<int>& last_frame,
               const TaxelDropout& dropout, int channel = 0);

 private:
  Launch gather_;
};

}  // namespace touchtrace
