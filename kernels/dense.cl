// Dense layers and their gradients on CPUs.
//
//   gemm:         C[m][n] = bias[m % bias_rows][n] + sum_k A(m, k) B[k][n]
//                 A(m, k) = a[a_at + m * a_row + k * a_step]
//   pack:         to[i][j] = from[from_at + i * from_row + j * from_step], 0 for j >= columns
//   column_sums:  sums[n] = sum_m a[m][n]
//
// Rows of B, of the bias, and of `a` in column_sums must be readable up to the next multiple of 16 columns. Needs
// cpu_tile.clh.
//
// -D PRODUCT_ROWS, EXACT: see cpu_tile.clh

static void store_narrow(narrow_tile t, int columns, int row, int rows, __global real* c, int ld) {
#define STORE(r) \
  if (row + r < rows) store_elements(t.a##r, columns, c + (size_t)(row + r) * ld);
  ROWS(STORE)
#undef STORE
}

// Pointers to rows (first + r) % rows of `matrix`.
static row_pointers repeated_rows_of(__global const real* matrix, int ld, int first, int rows) {
  row_pointers p;
#define POINT(r) p.x##r = matrix + (size_t)((first + r) % rows) * ld;
  ROWS(POINT)
#undef POINT
  return p;
}

// One work-item per PRODUCT_ROWS x 64 values of C. With bias_rows = 0 the bias is not read.
__kernel void gemm(__global const real* a, int a_at, int a_row, int a_step, __global const real* b,
                   int b_at, int b_ld, __global const real* bias, int bias_at, int bias_ld,
                   int bias_rows, __global real* c, int c_at, int c_ld, int rows, int columns,
                   int count) {
  const int row = get_global_id(0) * PRODUCT_ROWS;
  int n = get_global_id(1) * 64;
  const row_pointers x = rows_of(a + a_at, a_row, row, rows);
  const row_pointers start = repeated_rows_of(bias + bias_at, bias_ld, row, max(bias_rows, 1));
  b += b_at, c += c_at;
  if (columns - n >= 64) {
    wide_tile t = bias_rows ? load_wide(shifted(start, n)) : zero_wide();
    t = multiply_wide(t, x, a_step, b + n, b_ld, count);
    store_wide(t, row, rows, c + n, c_ld);
    return;
  }
  for (; n < columns; n += 16) {
    narrow_tile t = bias_rows ? load_narrow(shifted(start, n)) : fill_narrow((real16)(0));
    t = multiply_narrow(t, x, a_step, b + n, b_ld, count);
    store_narrow(t, columns - n, row, rows, c + n, c_ld);
  }
}

// pack() for from_row = 1 and a multiple of 16 rows. One work-item packs 16 rows, so that it uses whole cache lines of
// `from`.
__kernel void pack_transposed(__global const real* from, int from_at, int from_step, __global real* to, int to_at,
                          int to_row, int columns) {
  const int i = get_global_id(0) * 16;
  from += from_at + i;
  to += to_at + (size_t)i * to_row;
  for (int j = 0; j < columns; ++j)
    for (int row = 0; row < 16; ++row) to[row * to_row + j] = from[(size_t)j * from_step + row];
}

// One work-item per row of `to`.
__kernel void pack(__global const real* from, int from_at, int from_row, int from_step, int columns,
                   __global real* to, int to_at, int to_row, int to_columns) {
  const int i = get_global_id(0);
  from += from_at + (size_t)i * from_row;
  to += to_at + (size_t)i * to_row;
  for (int j = 0; j < to_columns; ++j) to[j] = j < columns ? from[j * from_step] : 0;
}

// One work-item per 16 columns.
__kernel void column_sums(__global const real* a, int a_at, int a_ld, __global real* sums, int sums_at,
                          int rows, int columns) {
  const int n = get_global_id(0) * 16;
  a += a_at + n;
  real16 sum = 0, compensation = 0;
  for (int m = 0; m < rows; ++m) ADD_TO(real16, sum, compensation, vload16(0, a + (size_t)m * a_ld))
  store_elements(sum, columns - n, sums + sums_at + n);
}
