#include "engine/ops/dense.h"

#include <string>

#include "engine/ops/lanes.h"

namespace touchtrace {
namespace {

constexpr int product_rows = 6;  // of a work-item of a CPU

Kernel dense_kernel(Runtime& runtime, const char* name) {
  return runtime.kernel({"common.clh", "tile.clh", "dense.cl"}, name,
                        {{"PRODUCT_ROWS", std::to_string(product_rows)}});
}

int tiles(int size, int tile) { return (size + tile - 1) / tile; }

Kernel lanes_kernel(Runtime& runtime, const char* name, const LanesTile& tile,
                    bool left_along_depth) {
  Defines defines{{"LEFT_ALONG_DEPTH", left_along_depth ? "1" : "0"}};
  tile.define(defines);
  return runtime.kernel({"common.clh", "lanes.clh", "dense_lanes.cl"}, name, defines);
}

/// Large tiles read less, but there must be enough of them for all compute units.
LanesTile lanes_tile_for(const Runtime& runtime, int rows, int columns) {
  const bool enough = tiles(rows, 64) * tiles(columns, 64) >= 2 * runtime.device().compute_units;
  return enough ? LanesTile{64, 64} : LanesTile{32, 32};
}

Launch gemm_launch(Runtime& runtime, const MatrixView& a, int rows, int columns,
                   const auto&... arguments) {
  if (runtime.body() == Body::vectors)
    return Launch(dense_kernel(runtime, "gemm"),
                  range(tiles(rows, product_rows), tiles(columns, 64)), arguments...);
  const auto tile = lanes_tile_for(runtime, rows, columns);
  return Launch(lanes_kernel(runtime, "gemm_lanes", tile, a.step == 1),
                range(tiles(rows, tile.rows), tiles(columns, tile.columns)), arguments...)
      .in_groups_of(tile.items());
}

Launch column_launch(Runtime& runtime, int columns, const auto&... arguments) {
  constexpr std::size_t group = 256;  // as in dense_lanes.cl
  if (runtime.body() == Body::vectors)
    return Launch(dense_kernel(runtime, "column_sums"), range(tiles(columns, 16)), arguments...);
  return Launch(lanes_kernel(runtime, "column_sums_lanes", {32, 32}, true),
                range(tiles(columns, 16)), arguments...)
      .in_groups_of(group);
}

}  // namespace

Launch gemm(Runtime& runtime, const MatrixView& a, const MatrixView& b,
            const std::optional<MatrixView>& bias, const MatrixView& c, int rows, int columns,
            int count, int bias_rows) {
  const MatrixView start = bias.value_or(b);
  return gemm_launch(runtime, a, rows, columns, a.buffer, a.at, a.row, a.step, b.buffer, b.at,
                     b.row, start.buffer, start.at, start.row, bias ? bias_rows : 0, c.buffer, c.at,
                     c.row, rows, columns, count)
      .costing(2.0 * rows * columns * count,
               4.0 * (1.0 * rows * count + 1.0 * count * columns + 1.0 * rows * columns))
      .serving(a.step == 1 ? Purpose::forward : Purpose::weights_gradient);
}

Launch pack(Runtime& runtime, const MatrixView& from, const MatrixView& to, int rows, int columns,
            int to_columns) {
  if (from.row == 1 && rows % 16 == 0 && columns == to_columns)
    return Launch(dense_kernel(runtime, "pack_turned"), range(rows / 16), from.buffer, from.at,
                  from.step, to.buffer, to.at, to.row, columns)
        .costing(0.0, 8.0 * rows * columns);
  return Launch(dense_kernel(runtime, "pack"), range(rows), from.buffer, from.at, from.row,
                from.step, columns, to.buffer, to.at, to.row, to_columns)
      .costing(0.0, 8.0 * rows * to_columns);
}

Launch column_sums(Runtime& runtime, const MatrixView& a, const MatrixView& sums, int rows,
                   int columns) {
  return column_launch(runtime, columns, a.buffer, a.at, a.row, sums.buffer, sums.at, rows, columns)
      .costing(1.0 * rows * columns, 4.0 * rows * columns);
}

}  // namespace touchtrace
