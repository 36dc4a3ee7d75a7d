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

/// Terms of a sum that one work-group of a GPU adds where a sum has more than long_sum: a few tiles
/// with long sums would occupy few compute units. Fixed, so that the order of a sum is, too.
constexpr int chunk_terms = 256, long_sum = 512;

/// C = bias + A B. `bias_rows` 0: no bias.
struct Product {
  MatrixView a, b, bias, c;
  int bias_rows, rows, columns, count;

  Launch with_cost_of(Launch launch) const {
    return std::move(launch)
        .with_cost(2.0 * rows * columns * count,
                   4.0 * (1.0 * rows * count + 1.0 * count * columns + 1.0 * rows * columns))
        .with_purpose(a.step == 1 ? Purpose::forward : Purpose::weight_gradient);
  }
};

Launches cpu_gemm(Runtime& runtime, const Product& p) {
  return {p.with_cost_of(Launch(
      dense_kernel(runtime, "gemm"), range(ceil_div(p.rows, product_rows), ceil_div(p.columns, 64)),
      p.a.buffer, p.a.at, p.a.row, p.a.step, p.b.buffer, p.b.at, p.b.row, p.bias.buffer, p.bias.at,
      p.bias.row, p.bias_rows, p.c.buffer, p.c.at, p.c.row, p.rows, p.columns, p.count))};
}

Launch gpu_gemm(Runtime& runtime, const Product& p, int chunk) {
  const auto tile = gpu_tile_for(runtime, p.rows, p.columns);
  return p.with_cost_of(Launch(gpu_kernel(runtime, "gemm_gpu", tile, p.a.step == 1),
                               range(ceil_div(p.rows, tile.rows), ceil_div(p.columns, tile.columns),
                                     ceil_div(p.count, chunk)),
                               p.a.buffer, p.a.at, p.a.row, p.a.step, p.b.buffer, p.b.at, p.b.row,
                               p.bias.buffer, p.bias.at, p.bias.row, p.bias_rows, p.c.buffer,
                               p.c.at, p.c.row, p.rows, p.columns, p.count, chunk)
                            .with_local_size(tile.items()));
}

Launches gpu_gemm_in_chunks(Runtime& runtime, const Product& p) {
  const int chunks = ceil_div(p.count, chunk_terms);
  auto partial = p;
  partial.bias_rows = 0;
  partial.c = {runtime.allocate<float>(std::size_t(chunks) * p.rows * p.columns), 0, p.columns};
  return {
      gpu_gemm(runtime, partial, chunk_terms),
      Launch(gpu_kernel(runtime, "add_chunks", {32, 32}, true), range(p.columns, p.rows),
             partial.c.buffer, chunks, p.bias.buffer, p.bias.at, p.bias.row, p.bias_rows,
             p.c.buffer, p.c.at, p.c.row)
          .with_cost(1.0 * chunks * p.rows * p.columns, 4.0 * (chunks + 1.0) * p.rows * p.columns)};
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

Launches gemm(Runtime& runtime, const MatrixView& a, const MatrixView& b,
              const std::optional<MatrixView>& bias, const MatrixView& c, int rows, int columns,
              int count, int bias_rows) {
  const Product product{a, b, bias.value_or(b), c, bias ? bias_rows : 0, rows, columns, count};
  if (runtime.kernel_variant() == KernelVariant::cpu) return cpu_gemm(runtime, product);
  if (count > long_sum) return gpu_gemm_in_chunks(runtime, product);
  return {gpu_gemm(runtime, product, count)};
}

Launch pack(Runtime& runtime, const MatrixView& from, const MatrixView& to, int rows, int columns,
            int to_columns) {
  if (runtime.kernel_variant() == KernelVariant::gpu)
    return Launch(gpu_kernel(runtime, "pack_gpu", {32, 32}, true), range(to_columns, rows),
                  from.buffer, from.at, from.row, from.step, columns, to.buffer, to.at, to.row)
        .with_cost(0.0, 8.0 * rows * to_columns);
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
