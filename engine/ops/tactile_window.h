#pragma once

#include <cstdint>

#include "engine/cl/launch.h"

namespace touchtrace {

/// Dropout of taxels: zeroes a fraction of them, the same ones in all frames of a window, and
/// divides the others by 1 - fraction. A hash of (key, window, taxel) selects them; draw a new key
/// for every update.
struct TaxelDropout {
  double share = 0.0;  ///< fraction in [0, 1)
  std::uint32_t key = 0;

  /// A taxel is zeroed if its hash is below this.
  std::uint32_t threshold() const;
};

struct TactileWindowShape {
  int windows, frames, rows, cols;  ///< `frames`: frames per window, M
  int halo = 1;                     ///< of the output

  std::size_t out_size() const;  ///< number of floats of the output, halo included
};

/// Gathers windows from a stream of frames [frame][row][column], in the difference basis, as planes
/// with a halo that the caller zeroes (kernels/conv2d.clh):
///
///     out[w] = keep[w] [5 (T_{t-M+2} - T_{t-M+1}), ..., 5 (T_t - T_{t-1}), T_t],  t =
///     last_frame[w]
class TactileWindow {
 public:
  /// Gathers windows first .. first + shape.windows - 1.
  TactileWindow(Runtime& runtime, const TactileWindowShape& shape, const Buffer<float>& out,
                int first = 0);
  /// `last_frame`: last frame of each window; its M frames must be inside `stream`.
  void enqueue(Runtime& runtime, const Buffer<float>& stream, const Buffer<int>& last_frame,
               const TaxelDropout& dropout);

 private:
  Launch gather_;
};

}  // namespace touchtrace
