// GPUs' bodies of gemm and column_sums in dense.cl, which gives the equations.

// A work-group computes a tile of C. `bias_rows` 0: `bias` is not read.
__kernel IN_GROUPS void gemm_lanes(
    __global const real* a, int a_at, int a_row, int a_step, __global const real* b, int b_at, int b_ld,
    __global const real* bias, int bias_at, int bias_ld, int bias_rows, __global real* c, int c_at, int
    c_ld, int rows, int columns, int count) {
  const int first = get_group_id(0) * TILE_ROWS, n = get_group_id(1) * TILE_COLUMNS;
  a += a_at + (size_t)first * a_row, b += b_at + n;
#define LEFT(q, r, k) (first + (r) < rows && (k) < count ? a[(size_t)(r) * a_row + (size_t)(k) * a_step] : 0)
#define RIGHT(k, c) (n + (c) < columns && (k) < count ? b[(size_t)(k) * b_ld + (c)] : 0)
  lane_tile tile = fill_lanes((real4)(0));
  INNER_PRODUCT(tile, count)
  const int column = n + lane_column();
#define STORE(r, sums)                                                                    \
  if (first + (r) < rows) {                                                               \
    real values[4];                                                                       \
    vstore4(sums, 0, values);                                                             \
    __global const real* start = bias + bias_at + (first + (r)) % max(bias_rows, 1) * bias_ld; \
    __global real* to = c + c_at + (size_t)(first + (r)) * c_ld;                          \
    for (int i = 0; i < 4; ++i)                                                           \
      if (column + i < columns) to[column + i] = values[i] + (bias_rows ? start[column + i] : 0); \
  }
  EACH_LANE_ROW(STORE)
}

// A work-group sums 16 columns: 16 lanes each take every 16th row, whose sums are then added in their order.
#define SLICES 16
__kernel __attribute__((reqd_work_group_size(16 * SLICES, 1, 1))) void column_sums_lanes(
    __global const real* a, int a_at, int a_ld, __global real* sums, int sums_at, int rows, int columns) {
  __local real slices[SLICES][16];
  const int slice = lane() / 16, n = get_group_id(0) * 16 + lane() % 16;
  real sum = 0, lost = 0;
  for (int m = slice; m < rows; m += SLICES)
    ADD_TO(real, sum, lost, n < columns ? a[a_at + (size_t)m * a_ld + n] : 0)
  slices[slice][lane() % 16] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (slice > 0 || n >= columns) return;
  sum = 0, lost = 0;
  for (int i = 0; i < SLICES; ++i) ADD_TO(real, sum, lost, slices[i][lane()])
  sums[sums_at + n] = sum;
}
