#include "engine/ops/dense.h"

#include <string>

#include "engine/base/integer_math.h"
#include "engine/ops/gpu_tile.h"

namespace touchtrace {
namespace {

constexpr int product_rows = 6;  // rows per work-item on CPUs

Kernel dense_kernel(Runtime& runtime, const char* name) {
  return runtime.kernel({"common.clh", "cpu_tile.clh", "dense.cl"}, name,
                        {{"PRODUCT_ROWS", std::to_string(product_rows)}});
}

Kernel gpu_kernel(Runtime& runtime, const char* name, const GpuTile& tile, bool left_along_depth) {
  Defines defines{{"LEFT_ALONG_DEPTH", left_along_depth ? "1" : "0"}};
  tile.define(defines);
  return runtime.kernel({"common.clh", "gpu_tile.clh", "dense_gpu.cl"}, name, defines);
}

/// Large tiles read less; small ones keep all compute units busy.
GpuTile gpu_tile_for(const Runtime& runtime, int rows, int columns) {
  const bool enough =
      ceil_div(rows, 64) * ceil_div(columns, 64) >= 2 * runtime.device().compute_units;
  return enough ? GpuTile{64, 64} : GpuTile{32, 32};
}

Launch gemm_launch(Runtime& runtime, const MatrixView& a, int rows, int columns,
                   const auto&... arguments) {
  if (runtime.kernel_variant() == KernelVariant::cpu)
    return Launch(dense_kernel(runtime, "gemm"),
                  range(ceil_div(rows, product_rows), ceil_div(columns, 64)), arguments...);
  const auto tile = gpu_tile_for(runtime, rows, columns);
  return Launch(gpu_kernel(runtime, "gemm_gpu", tile, a.step == 1),
                range(ceil_div(rows, tile.rows), ceil_div(columns, tile.columns)), arguments...)
      .with_local_size(tile.items());
}

Launch column_launch(Runtime& runtime, int columns, const auto&... arguments) {
  constexpr std::size_t group = 256;  // as in dense_gpu.cl
  if (runtime.kernel_variant() == KernelVariant::cpu)
    return Launch(dense_kernel(runtime, "column_sums"), range(ceil_div(columns, 16)), arguments...);
  return Launch(gpu_kernel(runtime, "column_sums_gpu", {32, 32}, true),
                range(ceil_div(columns, 16)), arguments...)
      .with_local_size(group);
}

}  // namespace

Launch gemm(Runtime& runtime, const MatrixView& a, const MatrixView& b,
            const std::optional<MatrixView>& bias, const MatrixView& c, int rows, int columns,
            int count, int bias_rows) {
  const MatrixView start = bias.value_or(b);
  return gemm_launch(runtime, a, rows, columns, a.buffer, a.at, a.row, a.step, b.buffer, b.at,
                     b.row, start.buffer, start.at, start.row, bias ? bias_rows : 0, c.buffer, c.at,
                     c.row, rows, columns, count)
      .with_cost(2.0 * rows * columns * count,
                 4.0 * (1.0 * rows * count + 1.0 * count * columns + 1.0 * rows * columns))
      .with_purpose(a.step == 1 ? Purpose::forward : Purpose::weight_gradient);
}

Launch pack(Runtime& runtime, const MatrixView& from, const MatrixView& to, int rows, int columns,
            int to_columns) {
  if (from.row == 1 && rows % 16 == 0 && columns == to_columns)
    return Launch(dense_kernel(runtime, "pack_transposed"), range(rows / 16), from.buffer, from.at,
                  from.step, to.buffer, to.at, to.row, columns)
        .with_cost(0.0, 8.0 * rows * columns);
  return Launch(dense_kernel(runtime, "pack"), range(rows), from.buffer, from.at, from.row,
                from.step, columns, to.buffer, to.at, to.row, to_columns)
      .with_cost(0.0, 8.0 * rows * to_columns);
}

Launch column_sums(Runtime& runtime, const MatrixView& a, const MatrixView& sums, int rows,
                   int columns) {
  return column_launch(runtime, columns, a.buffer, a.at, a.row, sums.buffer, sums.at, rows, columns)
      .with_cost(1.0 * rows * columns, 4.0 * rows * columns);
}

}  // namespace touchtrace
