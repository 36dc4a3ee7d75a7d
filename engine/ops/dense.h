#pragma once

#include <optional>

#include "engine/cl/launch.h"

namespace touchtrace {

/// Matrix inside a buffer: element (i, j) is at index `at + i * row + j * step`.
struct MatrixView {
  Buffer<float> buffer;
  int at = 0, row = 0, step = 1;

  MatrixView transposed() const { return {buffer, at, step, row}; }
  /// Submatrix from row `i`, or from column `j` on.
  MatrixView from_row(int i) const { return {buffer, at + i * row, row, step}; }
  MatrixView from_column(int j) const { return {buffer, at + j * step, row, step}; }
};

/// C[rows, columns] = A[rows, count] B[count, columns]; adds row m % bias_rows of `bias` to row m.
/// B, C and bias have step 1. Rows of B and bias must be readable up to the next multiple of 16
/// columns.
Launches gemm(Runtime& runtime, const MatrixView& a, const MatrixView& b,
              const std::optional<MatrixView>& bias, const MatrixView& c, int rows, int columns,
              int count, int bias_rows = 1);

/// Copies from[rows, columns] to to[rows, to_columns], with zeros beyond `columns`.
Launch pack(Runtime& runtime, const MatrixView& from, const MatrixView& to, int rows, int columns,
            int to_columns);

/// sums[columns] = sum over the rows of a[rows, columns]. Rows of `a` must be readable as in
/// gemm().
Launch column_sums(Runtime& runtime, const MatrixView& a, const MatrixView& sums, int rows,
                   int columns);

}  // namespace touchtrace
