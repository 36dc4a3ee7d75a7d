// Forward pass of conv2d_forward.cl in two launches, for input in planes: the first launch adds the bias and the
// channels below `channel`, the second the others. Without EXACT the result has the same bits as conv2d_forward.
// `sums` has the layout of the output.
//
// -D: see conv2d.clh, conv2d_pack.cl, conv2d_tile.clh

static tile load_sums(__global const real* sums, int first, int images) {
  tile t;
#define LOAD(b, p) SET_SUM(t, b, p, vload16(0, from + b * OUT_BLOCK))
#define LOAD_PIXEL(p)                                                                                       \
  {                                                                                                         \
    const uint pixel = ordered_pixel(min(first + p, images * OUT_AREA - 1), images);                        \
    __global const real* from = sums + out_offset(pixel);                                                    \
    EACH_BLOCK(LOAD, p)                                                                                     \
  }
  REPEAT(PIXELS, LOAD_PIXEL)
#undef LOAD_PIXEL
#undef LOAD
  return t;
}

__kernel void conv2d_first_half(__global const real* restrict in, __global const real* restrict packed,
                                __global const real* restrict parameters, int bias_at,
                                __global real* restrict sums, int images, int tiles, int channel) {
  const int group = get_global_id(1), pixels = images * OUT_AREA;
  const int begin = get_global_id(0) * tiles * PIXELS, end = min(begin + tiles * PIXELS, pixels);
  packed += group * IN_CHANNELS * CHANNEL_SIZE;
  sums += group * BLOCKS * OUT_BLOCK;
  for (int first = begin; first < end; first += PIXELS) {
    tile t = start_tile(parameters + bias_at + group * TAP_SIZE);
    if (first < images * LIVE) t = convolve(t, taps_of(in, first, images), packed, 0, channel);
    store_above(-INFINITY, t, sums, first, images);
  }
}

__kernel void conv2d_second_half(__global const real* restrict in, __global const real* restrict packed,
                                 __global const real* restrict sums, __global real* restrict out,
                                 int images, int tiles, int channel) {
  const int group = get_global_id(1), pixels = images * OUT_AREA;
  const int begin = get_global_id(0) * tiles * PIXELS, end = min(begin + tiles * PIXELS, pixels);
  packed += (group * IN_CHANNELS + channel) * CHANNEL_SIZE;
  sums += group * BLOCKS * OUT_BLOCK;
  out += group * BLOCKS * OUT_BLOCK;
  for (int first = begin; first < end; first += PIXELS) {
    tile t = load_sums(sums, first, images);
    if (first < images * LIVE) t = convolve(t, taps_of(in, first, images), packed, channel, IN_LANES);
    store_above(0, t, out, first, images);
  }
}
