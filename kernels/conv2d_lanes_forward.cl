// Forward pass of conv2d.clh on GPUs: rows of the product are output pixels, counted through all images, its
// columns output channels. A work-group a tile; TILE_COLUMNS divides OUT_CHANNELS. Tiles of dead pixels
// alone are not summed.
//
//   packed  [term][output channel]
#ifdef IN_PLANES
#define LEFT_ALONG_DEPTH 0
#else
#define LEFT_ALONG_DEPTH 1
#endif

// One work-item a weight.
__kernel void conv2d_lanes_pack(__global const real* restrict parameters, int weight_at,
                                __global real* restrict packed) {
  const int channel = get_global_id(0), term = get_global_id(1);
  packed[term * OUT_CHANNELS + channel] = parameters[weight_at + channel * TERMS + term_weight(term)];
}

__kernel IN_GROUPS void conv2d_lanes_forward(
    __global const real* restrict in, __global const real* restrict packed,
    __global const real* restrict parameters, int bias_at, __global real* restrict out, int images) {
  const int pixels = images * OUT_AREA, first = get_group_id(0) * TILE_ROWS;
  const int channel = get_group_id(1) * TILE_COLUMNS;
  size_t taps[LEFT_VALUES];
  for (int q = 0; q < LEFT_VALUES; ++q)
    taps[q] = tap_place(ordered_pixel(min(first + LEFT_ROW(q), pixels - 1), images));
#define LEFT(q, r, k) ((k) < TERMS ? in[taps[q] + term_place(k)] : 0)
#define RIGHT(k, c) ((k) < TERMS ? packed[(k) * OUT_CHANNELS + channel + (c)] : 0)
  lane_tile tile = fill_lanes(vload4(0, parameters + bias_at + channel + lane_column()));
  INNER_PRODUCT(tile, first < images * LIVE ? TERMS : 0)
  out += out_channel_place(channel + lane_column());
#define STORE(r, sums)      \
  if (first + (r) < pixels) \
    vstore4(max(sums, (real4)(0)), 0, out + out_place(ordered_pixel(first + (r), images)));
  EACH_LANE_ROW(STORE)
}
