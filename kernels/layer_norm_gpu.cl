// GPU variant of layer_norm.cl; equations and arrays: see there. 16 work-items share a row; each adds every 16th value:
// the order of the sums is that of the CPU variant.
//
// -D COLUMNS: multiple of 16, no default
// -D EXACT: the sums over a work-item's values are compensated
#define ROW_ITEMS 16
#define GROUP_ROWS 16
#define WORK_GROUP_ATTRIBUTE __attribute__((reqd_work_group_size(ROW_ITEMS * GROUP_ROWS, 1, 1)))
#define LANE ((int)get_local_id(0) % ROW_ITEMS)
#define EACH_COLUMN(n) for (int n = LANE; n < COLUMNS; n += ROW_ITEMS)
#define BARRIER barrier(CLK_LOCAL_MEM_FENCE);

// Row of the work-item; past the end, the last row. Input and output must not be one buffer: work-items past the end
// repeat the last row.
static size_t row_of(int rows) {
  return min((int)(get_group_id(0) * GROUP_ROWS + get_local_id(0) / ROW_ITEMS), rows - 1);
}

// Sum over the 16 work-items of a row. `sums` holds one value per work-item of the group.
static real row_sum(real value, __local real* sums) {
  BARRIER
  sums[get_local_id(0)] = value;
  BARRIER
  sums += (int)get_local_id(0) / ROW_ITEMS * ROW_ITEMS;
  real quarters[4];
  for (int i = 0; i < 4; ++i) quarters[i] = (sums[i] + sums[i + 8]) + (sums[i + 4] + sums[i + 12]);
  return quarters[0] + quarters[1] + quarters[2] + quarters[3];
}

__kernel WORK_GROUP_ATTRIBUTE void layer_norm_gpu(
    __global const real* x, __global const real* parameters, int gain_at, int bias_at, __global real* y,
    __global real* statistics, int rows) {
  __local real sums[ROW_ITEMS * GROUP_ROWS];
  const size_t row = row_of(rows);
  x += row * COLUMNS, y += row * COLUMNS;
  real sum = 0, squares = 0, sum_compensation = 0, squares_compensation = 0;
  EACH_COLUMN(n) ADD_TO(real, sum, sum_compensation, x[n])
  real mean = row_sum(sum, sums) / COLUMNS;
  sum = 0, sum_compensation = 0;
  EACH_COLUMN(n) {
    const real d = x[n] - mean;
    ADD_TO(real, sum, sum_compensation, d)
    ADD_PRODUCT(real, squares, squares_compensation, d, d)
  }
  const real correction = row_sum(sum, sums) / COLUMNS;
  const real scale = rsqrt(row_sum(squares, sums) / COLUMNS - correction * correction + (real)1e-5);
  mean += correction;
  EACH_COLUMN(n) y[n] = fma((x[n] - mean) * scale, parameters[gain_at + n], parameters[bias_at + n]);
  if (LANE == 0) statistics[2 * row] = mean, statistics[2 * row + 1] = scale;
}

__kernel WORK_GROUP_ATTRIBUTE void layer_norm_gpu_backward(
    __global const real* dy, __global const real* x, __global const real* statistics,
    __global const real* parameters, int gain_at, __global real* dx, int rows) {
  __local real sums[ROW_ITEMS * GROUP_ROWS];
  const size_t row = row_of(rows);
  dy += row * COLUMNS, x += row * COLUMNS, dx += row * COLUMNS;
  const real mean = statistics[2 * row], scale = statistics[2 * row + 1];
  real sum = 0, product = 0, sum_compensation = 0, product_compensation = 0;
  EACH_COLUMN(n) {
    const real g = dy[n] * parameters[gain_at + n];
    ADD_TO(real, sum, sum_compensation, g)
    ADD_PRODUCT(real, product, product_compensation, g, (x[n] - mean) * scale)
  }
  const real mean_g = row_sum(sum, sums) / COLUMNS, mean_gn = row_sum(product, sums) / COLUMNS;
  EACH_COLUMN(n) {
    const real g = dy[n] * parameters[gain_at + n];
    dx[n] = (g - mean_g - (x[n] - mean) * scale * mean_gn) * scale;
  }
}

// One work-group per 16 columns. Its work-items first add every GROUP_ROWS-th row of one column each.
__kernel WORK_GROUP_ATTRIBUTE void layer_norm_gpu_weights(
    __global const real* dy, __global const real* x, __global const real* statistics, int rows,
    __global real* gradient, int gain_at, int bias_at) {
  __local real gains[GROUP_ROWS][ROW_ITEMS], biases[GROUP_ROWS][ROW_ITEMS];
  const int first = get_local_id(0) / ROW_ITEMS, n = get_group_id(0) * ROW_ITEMS + LANE;
  real gain = 0, bias = 0, gain_compensation = 0, bias_compensation = 0;
  for (int row = first; row < rows; row += GROUP_ROWS) {
    const real d = dy[(size_t)row * COLUMNS + n];
    const real normal = (x[(size_t)row * COLUMNS + n] - statistics[2 * row]) * statistics[2 * row + 1];
    ADD_TO(real, gain, gain_compensation, d * normal)
    ADD_TO(real, bias, bias_compensation, d)
  }
  gains[first][LANE] = gain, biases[first][LANE] = bias;
  BARRIER
  if (first > 0) return;
  gain = 0, bias = 0, gain_compensation = 0, bias_compensation = 0;
  for (int i = 0; i < GROUP_ROWS; ++i) {
    ADD_TO(real, gain, gain_compensation, gains[i][LANE])
    ADD_TO(real, bias, bias_compensation, biases[i][LANE])
  }
  gradient[gain_at + n] = gain, gradient[bias_at + n] = bias;
}
