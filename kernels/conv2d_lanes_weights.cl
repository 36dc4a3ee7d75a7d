// Gradient of conv2d.clh towards weights and bias on GPUs, in two stages.
//
//   grad_weight[k][c][i][j] += sum_{images, y, x} grad_out[k][y][x] in[c][STRIDE y + i - HALO][STRIDE x + j - HALO]
//   grad_bias[k]            += sum_{images, y, x} grad_out[k][y][x]
//
// Output pixels, counted through all images, are cut into chunks. Each chunk is a matrix product: its rows are the
// convolution's terms and, after them, a one for the bias, its columns output channels, its own terms the chunk's
// pixels. A work-group sums a tile of one chunk, from zero with `start`, otherwise from what an earlier call left;
// TILE_COLUMNS divides OUT_CHANNELS. conv2d_lanes_reduce then adds the chunks in their order.
//
//   partial  [chunk][term, one][output channel]
#ifdef IN_PLANES
#define LEFT_ALONG_DEPTH 1
#else
#define LEFT_ALONG_DEPTH 0
#endif
#define SUMS (TERMS + 1)

__kernel IN_GROUPS void conv2d_lanes_weights(
    __global const real* restrict in, __global const real* restrict grad_out,
    __global real* restrict partial, int images, int chunk_pixels, int first_chunk, int start) {
  const int first = get_group_id(0) * TILE_ROWS, channel = get_group_id(1) * TILE_COLUMNS;
  const int begin = get_group_id(2) * chunk_pixels, pixels = min(chunk_pixels, images * OUT_AREA - begin);
  partial += ((size_t)(first_chunk + get_group_id(2)) * SUMS + first + lane_row()) * OUT_CHANNELS;
  partial += channel + lane_column();
  grad_out += out_channel_place(channel);
#define FACTOR(term, pixel) ((term) < TERMS ? in[tap_place(pixel) + term_place(term)] : (term) == TERMS)
#define LEFT(q, r, k) ((k) < pixels ? FACTOR(first + (r), begin + (k)) : 0)
#define RIGHT(k, c) ((k) < pixels ? grad_out[out_place(begin + (k)) + out_channel_place(c)] : 0)
  lane_tile tile = fill_lanes((real4)(0));
  INNER_PRODUCT(tile, pixels)
#define STORE(r, sums)                                                                          \
  if (first + (r) < SUMS) {                                                                     \
    __global real* to = partial + ((r) - lane_row()) * OUT_CHANNELS;                            \
    vstore4(start ? sums : vload4(0, to) + sums, 0, to);                                        \
  }
  EACH_LANE_ROW(STORE)
}

// A work-item adds a term of an output channel to gradient[weight_at + ...], or the bias.
__kernel void conv2d_lanes_reduce(__global const real* restrict partial, int chunks,
                                  __global real* restrict gradient, int weight_at, int bias_at) {
  const int channel = get_global_id(0), term = get_global_id(1);
  real sum = 0, lost = 0;
  for (int chunk = 0; chunk < chunks; ++chunk)
    ADD_TO(real, sum, lost, partial[((size_t)chunk * SUMS + term) * OUT_CHANNELS + channel])
  gradient[term < TERMS ? weight_at + channel * TERMS + term_weight(term) : bias_at + channel] += sum;
}
