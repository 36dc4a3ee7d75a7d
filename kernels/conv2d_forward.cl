// Forward pass of conv2d.clh, and the packing of its weights.
//
// A work-item computes `tiles` tiles one after the other: PIXELS output pixels, counted through all
// images in one row, times 32 channels.
//
// -D PIXELS=12: 2 accumulators each, so at most 15 fit the 32 registers of AVX-512.
#ifndef PIXELS
#define PIXELS 12
#endif

// packed[pair][channel][tap][lane], a work-item a (channel, pair). The weight of lane l and channel c
// stands at parameters[at + l * lane_stride + c * channel_stride].
__kernel void conv2d_pack(__global const real* restrict parameters, int at, int lane_stride,
                          int channel_stride, __global real* restrict packed) {
  const int channel = get_global_id(0), pair = get_global_id(1);
  __global const real* from = parameters + at + channel * channel_stride + pair * 32 * lane_stride;
  __global real* to = packed + (pair * (int)get_global_size(0) + channel) * CHANNEL_SIZE;
  for (int lane = 0; lane < 32; ++lane)
    for (int tap = 0; tap < 9; ++tap) to[tap * TAP_SIZE + lane] = from[lane * lane_stride + tap];
}

static void forward_tile(__global const real* restrict in, __global const real* restrict weights,
                         real16 bias0, real16 bias1, __global real* restrict out, int first, int pixels) {
#define START(p)                                                           \
  __global const real* in##p = in + tap_place(min(first + p, pixels - 1)); \
  real16 low##p = bias0, high##p = bias1;
  REPEAT(PIXELS, START)
#undef START
  for (int block = 0; block < IN_BLOCKS; ++block)
    for (int lane = 0; lane < IN_LANES; ++lane) {
      const int channel_at = block * IN_BLOCK + lane * IN_LANE;
#define MULTIPLY(p)                        \
  {                                        \
    const real16 x = (real16)(in##p[at]);  \
    low##p = fma(x, weight0, low##p);      \
    high##p = fma(x, weight1, high##p);    \
  }
#define TAP(i, j)                                                        \
  {                                                                      \
    const int at = channel_at + i * IN_PITCH + j * IN_STEP;              \
    const real16 weight0 = vload16((3 * i + j) * 2, weights);            \
    const real16 weight1 = vload16((3 * i + j) * 2 + 1, weights);        \
    REPEAT(PIXELS, MULTIPLY)                                             \
  }
      TAPS(TAP)
#undef TAP
#undef MULTIPLY
      weights += CHANNEL_SIZE;
    }
#define STORE(p)                                               \
  if (first + p < pixels) {                                    \
    __global real* to = out + out_place(first + p);            \
    vstore16(max(low##p, (real16)(0)), 0, to);                 \
    vstore16(max(high##p, (real16)(0)), 0, to + OUT_BLOCK);    \
  }
  REPEAT(PIXELS, STORE)
#undef STORE
}

__kernel void conv2d_forward(__global const real* restrict in, __global const real* restrict packed,
                             __global const real* restrict parameters, int bias_at,
                             __global real* restrict out, int images, int tiles) {
  const int pair = get_global_id(1), pixels = images * OUT_AREA;
  const real16 bias0 = vload16(0, parameters + bias_at + pair * 32);
  const real16 bias1 = vload16(1, parameters + bias_at + pair * 32);
  const int begin = get_global_id(0) * tiles * PIXELS, end = min(begin + tiles * PIXELS, pixels);
  for (int first = begin; first < end; first += PIXELS)
    forward_tile(in, packed + pair * IN_CHANNELS * CHANNEL_SIZE, bias0, bias1,
                 out + pair * 2 * OUT_BLOCK, first, pixels);
}
