// GPU variants of gemm, pack and column_sums; equations: dense.cl.
//
// -D: see gpu_tile.clh

// One work-group per tile of C and chunk of `chunk` terms of the sum; C has one matrix per chunk. With bias_rows = 0
// the bias is not read.
__kernel WORK_GROUP_ATTRIBUTE void gemm_gpu(
    __global const real* a, int a_at, int a_row, int a_step, __global const real* b, int b_at, int b_ld,
    __global const real* bias, int bias_at, int bias_ld, int bias_rows, __global real* c, int c_at, int
    c_ld, int rows, int columns, int count, int chunk) {
  const int begin = get_group_id(2) * chunk, terms = min(chunk, count - begin);
  const int first = get_group_id(0) * TILE_ROWS, n = get_group_id(1) * TILE_COLUMNS;
  a += a_at + (size_t)first * a_row + (size_t)begin * a_step, b += b_at + n + (size_t)begin * b_ld;
  c += c_at + (size_t)get_group_id(2) * rows * c_ld;
#define LEFT(q, r, k) (first + (r) < rows && (k) < terms ? a[(size_t)(r) * a_row + (size_t)(k) * a_step] : 0)
#define RIGHT(k, c) (n + (c) < columns && (k) < terms ? b[(size_t)(k) * b_ld + (c)] : 0)
  item_tile tile = fill_tile((real4)(0));
  INNER_PRODUCT(tile, terms)
  const int column = n + item_column();
#define STORE(r, sums)                                                                    \
  if (first + (r) < rows) {                                                               \
    real values[4];                                                                       \
    vstore4(sums, 0, values);                                                             \
    __global const real* start = bias + bias_at + (first + (r)) % max(bias_rows, 1) * bias_ld; \
    __global real* to = c + (size_t)(first + (r)) * c_ld;                                 \
    for (int i = 0; i < 4; ++i)                                                           \
      if (column + i < columns) to[column + i] = values[i] + (bias_rows ? start[column + i] : 0); \
  }
  EACH_ITEM_ROW(STORE)
}

// C[m][n] = bias[m % bias_rows][n] + sum of C over chunks [chunk][rows][columns]. One work-item per value.
__kernel void add_chunks(__global const real* partial, int chunks, __global const real* bias, int bias_at, int bias_ld,
                         int bias_rows, __global real* c, int c_at, int c_ld) {
  const size_t n = get_global_id(0), m = get_global_id(1), columns = get_global_size(0), rows = get_global_size(1);
  real sum = bias_rows ? bias[bias_at + m % max(bias_rows, 1) * bias_ld + n] : 0, compensation = 0;
  for (int chunk = 0; chunk < chunks; ++chunk)
    ADD_TO(real, sum, compensation, partial[(chunk * rows + m) * columns + n])
  c[c_at + m * c_ld + n] = sum;
}

// One work-item per value of `to`.
__kernel void pack_gpu(__global const real* from, int from_at, int from_row, int from_step, int columns,
                       __global real* to, int to_at, int to_row) {
  const size_t j = get_global_id(0), i = get_global_id(1);
  to[to_at + i * to_row + j] = j < columns ? from[from_at + i * from_row + j * from_step] : 0;
}

// One work-group per 16 columns. 16 work-items per column each add every 16th row; one of them adds their sums in
// ascending order.
#define SLICES 16
__kernel __attribute__((reqd_work_group_size(16 * SLICES, 1, 1))) void column_sums_gpu(
    __global const real* a, int a_at, int a_ld, __global real* sums, int sums_at, int rows, int columns) {
  __local real slices[SLICES][16];
  const int slice = item() / 16, n = get_group_id(0) * 16 + item() % 16;
  real sum = 0, compensation = 0;
  for (int m = slice; m < rows; m += SLICES)
    ADD_TO(real, sum, compensation, n < columns ? a[a_at + (size_t)m * a_ld + n] : 0)
  slices[slice][item() % 16] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (slice > 0 || n >= columns) return;
  sum = 0, compensation = 0;
  for (int i = 0; i < SLICES; ++i) ADD_TO(real, sum, compensation, slices[i][item()])
  sums[sums_at + n] = sum;
}
