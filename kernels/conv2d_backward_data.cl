// Gradient of conv2d.clh towards its input, which must stand in blocks:
//
//   grad_in[c][y][x] = [in[c][y][x] > 0] sum_{k, taps} weight[k][c][i][j] grad_out[k][..][..]
//
// with the mask of the ReLU that made the input. A gather, so that nothing is added twice and there are no
// atomics. Input pixels (STRIDE a + r, STRIDE b + c) of all a and b make the class (r, c): with stride 1 there
// is one class, with stride 2 there are four, by parity. Output pixel (a + y, b + x) meets a class through the
// tap (r + HALO - STRIDE y, c + HALO - STRIDE x), if there is such a tap.
//
// Weights are packed with input channels as lanes, summed over output channels. A work-item computes `tiles`
// times a tile (conv2d_tile.clh) of each class, its pixels being places (a, b) of the output.

// The largest and the smallest y and x.
#define LAST ((HALO + STRIDE - 1) / STRIDE)
#define FIRST (-(HALO / STRIDE))

// One class meets every y and x. Of several, which meets which is known beforehand if all rows are unrolled.
#if STRIDE == 1
#define EACH_CLASS(F) F(0, 0)
#define UNROLLED_ROWS 1
#else
#define EACH_CLASS(F) F(0, 0) F(0, 1) F(1, 0) F(1, 1)
#define UNROLLED_ROWS (LAST - FIRST + 1)
#endif

static bool is_tap(int i) { return i >= 0 && i < KERNEL; }

static places outputs_of(__global const real* grad_out, int first, int pixels) {
  places from;
#define PLACE(p) from.pixel##p = grad_out + out_place(min(first + p, pixels - 1));
  REPEAT(PIXELS, PLACE)
#undef PLACE
  return from;
}

static void store_masked(real16 value, __global const real* in, __global real* grad_in) {
  store16(select((real16)(0), value, vload16(0, in) > (real16)(0)), 0, grad_in);
}

static bool is_inside(int pixel, int r, int c) {
  return STRIDE * (pixel % OUT_AREA / OUT_COLS) + r < IN_ROWS && STRIDE * (pixel % OUT_COLS) + c < IN_COLS;
}

static void store_class(tile t, __global const real* in, __global real* grad_in, int first, int pixels, int r,
                        int c) {
#define STORE(b, p) store_masked(t.sum##b##_##p, in + at + b * IN_BLOCK, grad_in + at + b * IN_BLOCK);
#define STORE_PIXEL(p)                                                               \
  if (first + p < pixels && is_inside(first + p, r, c)) {                            \
    const size_t at = tap_place(first + p) + IN_CORNER + r * IN_PITCH + c * IN_STEP; \
    EACH_BLOCK(STORE, p)                                                             \
  }
  REPEAT(PIXELS, STORE_PIXEL)
#undef STORE_PIXEL
#undef STORE
}

static void data_tiles(__global const real* restrict grad_out, __global const real* restrict weights,
                       __global const real* restrict in, __global real* restrict grad_in, int first,
                       int pixels) {
  const places from = outputs_of(grad_out, first, pixels);
#define START(r, c) tile sum##r##c = zero_tile();
  EACH_CLASS(START)
#undef START
  for (int block = 0; block < OUT_CHANNELS / 16; ++block)
    for (int lane = 0; lane < 16; ++lane, weights += CHANNEL_SIZE) {
#pragma unroll UNROLLED_ROWS
      for (int y = LAST; y >= FIRST; --y)
#pragma unroll
        for (int x = LAST; x >= FIRST; --x) {
          const int at = block * OUT_BLOCK + lane + y * OUT_PITCH + x * OUT_STEP;
#define ADD(r, c)                                                                      \
  {                                                                                    \
    const int i = r + HALO - STRIDE * y, j = c + HALO - STRIDE * x;                    \
    if (is_tap(i) && is_tap(j))                                                        \
      sum##r##c = add_tap(sum##r##c, from, at, weights + (KERNEL * i + j) * TAP_SIZE); \
  }
          EACH_CLASS(ADD)
#undef ADD
        }
    }
#define STORE(r, c) store_class(sum##r##c, in, grad_in, first, pixels, r, c);
  EACH_CLASS(STORE)
#undef STORE
}

__kernel void conv2d_backward_data(__global const real* restrict grad_out,
                                   __global const real* restrict packed,
                                   __global const real* restrict in, __global real* restrict grad_in,
                                   int images, int tiles) {
  const int group = get_global_id(1), pixels = images * OUT_AREA;
  const int begin = get_global_id(0) * tiles * PIXELS, end = min(begin + tiles * PIXELS, pixels);
  packed += group * OUT_CHANNELS * CHANNEL_SIZE;
  in += group * BLOCKS * IN_BLOCK;
  grad_in += group * BLOCKS * IN_BLOCK;
  for (int first = begin; first < end; first += PIXELS)
    data_tiles(grad_out, packed, in, grad_in, first, pixels);
}
