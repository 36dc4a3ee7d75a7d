// Forward pass and gradient with respect to the input of winograd.clh. Matrix products: cpu_tile.clh.
//
// A work-item uses local memory for its own points only. The work-group size is therefore 1, so that work-items never
// share it.
//
// -D TILE_MEMORY=__local, GROUP_IMAGES, no defaults here
// Other -D: see conv2d.clh
#define ONE_WORK_ITEM __attribute__((reqd_work_group_size(1, 1, 1)))

// [rows, count] times [count, 64], or [count, 32] if only 32 columns are left.
static void multiply_columns(__local const real* in, int count, __global const real* weights,
                             __local real* out, int columns, int n, int rows) {
  for (int row = 0; row < rows; row += 4) {
    const row_pointers x = rows_of(in, count, row, rows);
    if (columns - n >= 64)
      store_wide(multiply_wide(zero_wide(), x, 1, weights + n, columns, count), row, rows, out + n, columns);
    else
      store_half(multiply_half(zero_half(), x, 1, weights + n, columns, count), row, rows, out + n, columns);
  }
}

// out[point] = in[point] weights[set of the point]. Goes through all points of a set for 64 columns at a time, which
// stay in the cache.
static void multiply_points(__local const real* in, int in_stride, int count, __global const real* weights,
                            __local real* out, int out_stride, int columns, int rows) {
  for (int set = 0; set < WEIGHT_SETS; ++set, weights += count * columns)
    for (int n = 0; n < columns; n += 64) {
      const int a = set / 6, b = set % 6;
      for (int i = a; i < (a == 5 ? 9 : a + 1); ++i)
        for (int j = b; j < (b == 5 ? 9 : b + 1); ++j)
          multiply_columns(in + (9 * i + j) * in_stride, count, weights, out + (9 * i + j) * out_stride,
                           columns, n, rows);
    }
}

__kernel ONE_WORK_ITEM void winograd_forward(__global const real* restrict in, __global const real* restrict weights,
                                             __global const real* restrict parameters, int bias_at,
                                             __global real* restrict out, int images) {
  __local real in_points[POINTS * IN_STRIDE], out_points[POINTS * OUT_STRIDE];
  const int first = get_global_id(0) * GROUP_IMAGES, tiles = min(GROUP_IMAGES, images - first) * TILES;
  in += (size_t)first * IN_IMAGE;
  out += (size_t)first * OUT_IMAGE;
  for (int tile = 0; tile < tiles; ++tile)
    points_of_tile(in + tile / TILES * IN_IMAGE, tile, in_points + tile * IN_CHANNELS);
  multiply_points(in_points, IN_STRIDE, IN_CHANNELS, weights, out_points, OUT_STRIDE, OUT_CHANNELS, tiles);
  for (int tile = 0; tile < tiles; ++tile)
    outputs_of_tile(out_points + tile * OUT_CHANNELS, parameters + bias_at, tile,
                    out + tile / TILES * OUT_IMAGE);
}

// `weights`: transposed, [36][OUT_CHANNELS][IN_CHANNELS].
__kernel ONE_WORK_ITEM void winograd_backward_data(__global const real* restrict grad_out,
                                                   __global const real* restrict weights,
                                                   __global const real* restrict in, __global real* restrict grad_in,
                                                   int images) {
  __local real in_points[POINTS * IN_STRIDE], out_points[POINTS * OUT_STRIDE];
  const int first = get_global_id(0) * GROUP_IMAGES, tiles = min(GROUP_IMAGES, images - first) * TILES;
  grad_out += (size_t)first * OUT_IMAGE;
  in += (size_t)first * IN_IMAGE;
  grad_in += (size_t)first * IN_IMAGE;
  for (int tile = 0; tile < tiles; ++tile)
    points_of_output_gradient(grad_out + tile / TILES * OUT_IMAGE, tile, out_points + tile * OUT_CHANNELS);
  multiply_points(out_points, OUT_STRIDE, OUT_CHANNELS, weights, in_points, IN_STRIDE, IN_CHANNELS, tiles);
  for (int tile = 0; tile < tiles; ++tile)
    add_input_gradient(in_points + tile * IN_CHANNELS, in + tile / TILES * IN_IMAGE, tile,
                       grad_in + tile / TILES * IN_IMAGE);
}
