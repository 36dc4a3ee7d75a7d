#include "engine/ops/tactile_window.h"

#include <cmath>

namespace touchtrace {
namespace {

/// Vector width that fits a row. The last vector of a row overlaps the one before.
int lanes_of(int cols) { return cols >= 16 ? 16 : cols >= 8 ? 8 : cols >= 4 ? 4 : 1; }

/// Work-items of a row: on GPUs, one per taxel.
int row_items(const Runtime& runtime, const TactileWindowShape& shape) {
  return runtime.kernel_variant() == KernelVariant::gpu ? shape.cols : 1;
}

Kernel tactile_window_kernel(Runtime& runtime, const TactileWindowShape& shape) {
  const int items = row_items(runtime, shape);
  return runtime.kernel({"common.clh", "tactile_window.cl"}, "tactile_window",
                        {{"WINDOW", std::to_string(shape.frames)},
                         {"ROWS", std::to_string(shape.rows)},
                         {"COLS", std::to_string(shape.cols)},
                         {"HALO", std::to_string(shape.halo)},
                         {"LANES", std::to_string(items > 1 ? 1 : lanes_of(shape.cols))},
                         {"ROW_ITEMS", std::to_string(items)}});
}

}  // namespace

std::size_t TactileWindowShape::out_size() const {
  return static_cast<std::size_t>(windows) * frames * (rows + 2 * halo) * (cols + 2 * halo);
}

std::uint32_t TaxelDropout::threshold() const {
  return static_cast<std::uint32_t>(std::floor(share * 0x1p32));
}

TactileWindow::TactileWindow(Runtime& runtime, const TactileWindowShape& shape,
                             const Buffer<float>& out, int first)
    : gather_(tactile_window_kernel(runtime, shape),
              range(shape.rows * row_items(runtime, shape), shape.windows), out, out, out,
              cl_uint{0}, cl_uint{0}, 1.0f, first) {}

void TactileWindow::enqueue(Runtime& runtime, const Buffer<float>& stream,
                            const Buffer<int>& last_frame, const TaxelDropout& dropout) {
  gather_.set(0, stream);
  gather_.set(1, last_frame);
  gather_.set(3, dropout.key);
  gather_.set(4, dropout.threshold());
  gather_.set(5, static_cast<float>(1.0 / (1.0 - dropout.share)));
  gather_.enqueue(runtime);
}

}  // namespace touchtrace
