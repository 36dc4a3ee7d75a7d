// Gradient of the convolution with respect to weights and bias on CPUs (layout: conv2d.clh), in two stages.
//
//   grad_weight[k][c][i][j] += sum_{images, y, x} grad_out[k][y][x] in[c][row][column]
//   grad_bias[k]            += sum_{images, y, x} grad_out[k][y][x]
//
// 1. conv2d_backward_weights: images are divided into chunks. One work-item sums one chunk for one pair of output
//    blocks and one block of input channels. It goes through groups of GROUP_IMAGES images, which stay in the
//    first-level cache, and for each channel keeps TAP_ROWS rows of taps x 32 output channels in registers. With
//    `start` != 0 the sums start from zero, otherwise from the chunk's partial sums of an earlier call; a chunk
//    without images gets zeros. `first_chunk`: index of this call's first chunk in the partial sums.
// 2. conv2d_reduce adds the chunks in ascending order, so the rounding depends on the number of chunks but not on
//    threads.
//
//   partial       [chunk][pair][input channel][tap][32]
//   partial_bias  [chunk][pair][32]
//
// -D EXACT: sums are compensated within a group of images, and over chunks
// -D GROUP_IMAGES=4
// Other -D: see conv2d.clh
#ifndef GROUP_IMAGES
#define GROUP_IMAGES 4
#endif
#define PAIRS (OUT_CHANNELS / 32)
#define CHANNEL_SIZE (TAPS * 32)

// Rows of taps whose accumulators fit into the registers, and the number of their taps.
#if KERNEL == 3
#define TAP_ROWS 3
#define ROW_TAPS 9
#else
#define TAP_ROWS 1
#define ROW_TAPS 5
#endif

static void weights_of_taps(__global const real* in, __global const real* grad_out,
                            __global real* partial, int images, bool start) {
#define START(t)                                                      \
  real16 low##t = start ? (real16)(0) : vload16(2 * t, partial);      \
  real16 high##t = start ? (real16)(0) : vload16(2 * t + 1, partial); \
  real16 low_compensation##t = 0, high_compensation##t = 0;
  REPEAT(ROW_TAPS, START)
#undef START
  for (int image = 0; image < images; ++image)
    for (int i = 0; i < LIVE; ++i) {
      const int y = ORDERED(i) / OUT_COLS, x = ORDERED(i) % OUT_COLS;
      __global const real* g = grad_out + image * OUT_IMAGE + y * OUT_PITCH + x * OUT_STEP;
      __global const real* taps = in + image * IN_IMAGE + STRIDE * (y * IN_PITCH + x * IN_STEP);
      const real16 g0 = vload16(0, g), g1 = vload16(0, g + OUT_BLOCK);
#define ADD(t)                                                                         \
  {                                                                                    \
    const real16 value = (real16)(taps[t / KERNEL * IN_PITCH + t % KERNEL * IN_STEP]); \
    ADD_PRODUCT(real16, low##t, low_compensation##t, value, g0)                        \
    ADD_PRODUCT(real16, high##t, high_compensation##t, value, g1)                      \
  }
      REPEAT(ROW_TAPS, ADD)
#undef ADD
    }
#define STORE(t)                    \
  store16(low##t, 2 * t, partial); \
  store16(high##t, 2 * t + 1, partial);
  REPEAT(ROW_TAPS, STORE)
#undef STORE
}

static void weights_of_channel(__global const real* in, __global const real* grad_out,
                               __global real* partial, int images, bool start) {
  for (int row = 0; row < KERNEL; row += TAP_ROWS)
    weights_of_taps(in + row * IN_PITCH, grad_out, partial + row * KERNEL * 32, images, start);
}

static void bias_of_pair(__global const real* grad_out, __global real* partial, int images, int start) {
  real16 low = start ? (real16)(0) : vload16(0, partial);
  real16 high = start ? (real16)(0) : vload16(1, partial);
  real16 low_compensation = 0, high_compensation = 0;
  for (int image = 0; image < images; ++image)
    for (int y = 0; y < OUT_ROWS; ++y)
      for (int x = 0; x < OUT_COLS; ++x) {
        __global const real* g = grad_out + image * OUT_IMAGE + y * OUT_PITCH + x * OUT_STEP;
        ADD_TO(real16, low, low_compensation, vload16(0, g))
        ADD_TO(real16, high, high_compensation, vload16(0, g + OUT_BLOCK))
      }
  store16(low, 0, partial);
  store16(high, 1, partial);
}

__kernel void conv2d_backward_weights(__global const real* restrict in,
                                      __global const real* restrict grad_out,
                                      __global real* restrict partial,
                                      __global real* restrict partial_bias, int images, int chunk_images,
                                      int first_chunk, int start) {
  const int pair = get_global_id(0), block = get_global_id(1), chunk = get_global_id(2);
  const int begin = min(chunk * chunk_images, images), end = min(begin + chunk_images, images);
  const int sums = (first_chunk + chunk) * PAIRS + pair;
  __global const real* g = grad_out + pair * 2 * OUT_BLOCK + OUT_CORNER;
  __global real* to = partial + (sums * IN_CHANNELS + block * IN_LANES) * CHANNEL_SIZE;
  for (int first = begin; first < end || (start && first == begin); first += GROUP_IMAGES)
    for (int lane = 0; lane < IN_LANES; ++lane)
      weights_of_channel(in + (size_t)first * IN_IMAGE + block * IN_BLOCK + lane * IN_LANE,
                         g + (size_t)first * OUT_IMAGE, to + lane * CHANNEL_SIZE,
                         min(GROUP_IMAGES, end - first), start && first == begin);
  if (block == 0)
    bias_of_pair(g + (size_t)begin * OUT_IMAGE, partial_bias + sums * 32, end - begin, start);
}

static real16 sum_of_chunks(__global const real* from, int chunks, int stride) {
  real16 sum = vload16(0, from), compensation = 0;
  for (int chunk = 1; chunk < chunks; ++chunk)
    ADD_TO(real16, sum, compensation, vload16(0, from + (size_t)chunk * stride))
  return sum;
}

// One work-item per (input channel, pair) adds to gradient[weight_at + ...]; those of channel 0 also add the bias.
__kernel void conv2d_reduce(__global const real* restrict partial,
                            __global const real* restrict partial_bias, int chunks,
                            __global real* restrict gradient, int weight_at, int bias_at) {
  const int channel = get_global_id(0), pair = get_global_id(1);
  __global const real* from = partial + (pair * IN_CHANNELS + channel) * CHANNEL_SIZE;
  __global real* to = gradient + weight_at + (pair * 32 * IN_CHANNELS + channel) * TAPS;
  for (int half_tap = 0; half_tap < 2 * TAPS; ++half_tap) {
    real sums[16];
    store16_private(sum_of_chunks(from + half_tap * 16, chunks, PAIRS * IN_CHANNELS * CHANNEL_SIZE), 0, sums);
    for (int lane = 0; lane < 16; ++lane)
      to[(half_tap % 2 * 16 + lane) * IN_CHANNELS * TAPS + half_tap / 2] += sums[lane];
  }
  if (channel == 0)
    for (int half_pair = 0; half_pair < 2; ++half_pair) {
      __global real* bias = gradient + bias_at + pair * 32 + half_pair * 16;
      __global const real* bias_from = partial_bias + pair * 32 + half_pair * 16;
      store16(vload16(0, bias) + sum_of_chunks(bias_from, chunks, PAIRS * 32), 0, bias);
    }
}
