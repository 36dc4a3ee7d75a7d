// Gradient of the convolution with respect to weights and bias on GPUs (layout: conv2d.clh), in two stages.
//
//   grad_weight[k][c][i][j] += sum_{images, y, x} grad_out[k][y][x] in[c][STRIDE y + i - HALO][STRIDE x + j - HALO]
//   grad_bias[k]            += sum_{images, y, x} grad_out[k][y][x]
//
// 1. conv2d_gpu_weights: output pixels, counted through all images, are divided into chunks. Each chunk is a matrix
//    product: rows are the convolution's terms followed by a constant 1 for the bias, columns are output channels,
//    terms are the chunk's pixels. One work-group per tile of one chunk (gpu_tile.clh); TILE_COLUMNS divides
//    OUT_CHANNELS. With `start` != 0 the sums start from zero, otherwise from the partial sums of an earlier call.
// 2. conv2d_gpu_reduce adds the chunks in ascending order.
//
//   partial [chunk][term, then bias][output channel]
//
// -D: see conv2d.clh, gpu_tile.clh
#ifdef IN_PLANES
#define LEFT_ALONG_DEPTH 1
#else
#define LEFT_ALONG_DEPTH 0
#endif
#define SUMS (TERMS + 1)

__kernel WORK_GROUP_ATTRIBUTE void conv2d_gpu_weights(
    __global const real* restrict in, __global const real* restrict grad_out,
    __global real* restrict partial, int images, int chunk_pixels, int first_chunk, int start) {
  const int first = get_group_id(0) * TILE_ROWS, channel = get_group_id(1) * TILE_COLUMNS;
  const int begin = get_group_id(2) * chunk_pixels, pixels = min(chunk_pixels, images * OUT_AREA - begin);
  partial += ((size_t)(first_chunk + get_group_id(2)) * SUMS + first + item_row()) * OUT_CHANNELS;
  partial += channel + item_column();
  grad_out += out_channel_offset(channel);
#define FACTOR(term, pixel) ((term) < TERMS ? in[tap_offset(pixel) + term_offset(term)] : (term) == TERMS)
#define LEFT(q, r, k) ((k) < pixels ? FACTOR(first + (r), begin + (k)) : 0)
#define RIGHT(k, c) ((k) < pixels ? grad_out[out_offset(begin + (k)) + out_channel_offset(c)] : 0)
  item_tile tile = fill_tile((real4)(0));
  INNER_PRODUCT(tile, pixels)
#define STORE(r, sums)                                                                          \
  if (first + (r) < SUMS) {                                                                     \
    __global real* to = partial + ((r) - item_row()) * OUT_CHANNELS;                            \
    vstore4(start ? sums : vload4(0, to) + sums, 0, to);                                        \
  }
  EACH_ITEM_ROW(STORE)
}

// One work-item per (output channel, term) adds to gradient[weight_at + ...], or to the bias.
__kernel void conv2d_gpu_reduce(__global const real* restrict partial, int chunks,
                                  __global real* restrict gradient, int weight_at, int bias_at) {
  const int channel = get_global_id(0), term = get_global_id(1);
  real sum = 0, compensation = 0;
  for (int chunk = 0; chunk < chunks; ++chunk)
    ADD_TO(real, sum, compensation, partial[((size_t)chunk * SUMS + term) * OUT_CHANNELS + channel])
  gradient[term < TERMS ? weight_at + channel * TERMS + term_weight_offset(term) : bias_at + channel] += sum;
}
