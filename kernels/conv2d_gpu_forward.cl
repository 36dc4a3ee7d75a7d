// Forward pass of the convolution on GPUs (equation and layout: conv2d.clh) as a matrix product: rows are output
// pixels, counted through all images, columns are output channels. One work-group per tile (gpu_tile.clh);
// TILE_COLUMNS divides OUT_CHANNELS. Tiles that hold only dead pixels skip the sum.
//
//   packed [term][output channel]
//
// -D: see conv2d.clh, gpu_tile.clh
#ifdef IN_PLANES
#define LEFT_ALONG_DEPTH 0
#else
#define LEFT_ALONG_DEPTH 1
#endif

// One work-item per weight.
__kernel void conv2d_gpu_pack(__global const real* restrict parameters, int weight_at,
                                __global real* restrict packed) {
  const int channel = get_global_id(0), term = get_global_id(1);
  packed[term * OUT_CHANNELS + channel] = parameters[weight_at + channel * TERMS + term_weight_offset(term)];
}

__kernel WORK_GROUP_ATTRIBUTE void conv2d_gpu_forward(
    __global const real* restrict in, __global const real* restrict packed,
    __global const real* restrict parameters, int bias_at, __global real* restrict out, int images) {
  const int pixels = images * OUT_AREA, first = get_group_id(0) * TILE_ROWS;
  const int channel = get_group_id(1) * TILE_COLUMNS;
  size_t taps[LEFT_VALUES];
  for (int q = 0; q < LEFT_VALUES; ++q)
    taps[q] = tap_offset(ordered_pixel(min(first + LEFT_ROW(q), pixels - 1), images));
#define LEFT(q, r, k) ((k) < TERMS ? in[taps[q] + term_offset(k)] : 0)
#define RIGHT(k, c) ((k) < TERMS ? packed[(k) * OUT_CHANNELS + channel + (c)] : 0)
  item_tile tile = fill_tile(vload4(0, parameters + bias_at + channel + item_column()));
  INNER_PRODUCT(tile, first < images * LIVE ? TERMS : 0)
  out += out_channel_offset(channel + item_column());
#define STORE(r, sums)      \
  if (first + (r) < pixels) \
    vstore4(max(sums, (real4)(0)), 0, out + out_offset(ordered_pixel(first + (r), images)));
  EACH_ITEM_ROW(STORE)
}
