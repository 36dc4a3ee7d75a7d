// Forward pass of the convolution on CPUs (equation and layout: conv2d.clh). One work-item computes `tiles` tiles
// (conv2d_tile.clh) of output pixels and output channels, one after another.
//
// -D: see conv2d.clh, conv2d_pack.cl, conv2d_tile.clh

static pixel_pointers taps_of(__global const real* in, int first, int images) {
  pixel_pointers from;
#define POINT(p) from.pixel##p = in + tap_offset(ordered_pixel(min(first + p, images * OUT_AREA - 1), images));
  REPEAT(PIXELS, POINT)
#undef POINT
  return from;
}

static tile convolve(tile t, pixel_pointers from, __global const real* weights) {
  for (int block = 0; block < IN_BLOCKS; ++block)
    for (int lane = 0; lane < IN_LANES; ++lane) {
      const int at = block * IN_BLOCK + lane * IN_LANE;
      for (int i = 0; i < KERNEL; ++i)
#pragma unroll
        for (int j = 0; j < KERNEL; ++j, weights += TAP_SIZE)
          t = add_tap(t, from, at + i * IN_PITCH + j * IN_STEP, weights);
    }
  return t;
}

static void store_relu(tile t, __global real* out, int first, int images) {
#define STORE(b, p) store16(max(t.sum##b##_##p, (real16)(0)), 0, to + b * OUT_BLOCK);
#define STORE_PIXEL(p)                                                     \
  if (first + p < images * OUT_AREA) {                                     \
    __global real* to = out + out_offset(ordered_pixel(min(first + p, images * OUT_AREA - 1), images)); \
    EACH_BLOCK(STORE, p)                                                   \
  }
  REPEAT(PIXELS, STORE_PIXEL)
#undef STORE_PIXEL
#undef STORE
}

__kernel void conv2d_forward(__global const real* restrict in, __global const real* restrict packed,
                             __global const real* restrict parameters, int bias_at,
                             __global real* restrict out, int images, int tiles) {
  const int group = get_global_id(1), pixels = images * OUT_AREA;
  const int begin = get_global_id(0) * tiles * PIXELS, end = min(begin + tiles * PIXELS, pixels);
  packed += group * IN_CHANNELS * CHANNEL_SIZE;
  out += group * BLOCKS * OUT_BLOCK;
  for (int first = begin; first < end; first += PIXELS) {
    tile t = start_tile(parameters + bias_at + group * TAP_SIZE);
    if (first < images * LIVE) t = convolve(t, taps_of(in, first, images), packed);
    store_relu(t, out, first, images);
  }
}
