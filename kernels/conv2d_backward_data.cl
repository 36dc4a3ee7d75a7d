// Gradient of the convolution with respect to its input on CPUs; the input is in blocks (conv2d.clh).
//
//   grad_in[c][y][x] = [in[c][y][x] > 0] sum_{k, taps} weight[k][c][i][j] grad_out[k][..][..]
//
// The factor [in > 0] is the mask of the ReLU that made the input. The sum is a gather, so that no atomics are needed.
// Input pixels (STRIDE a + r, STRIDE b + c) for all a, b form class (r, c): one class with stride 1, four with stride
// 2. Output pixel (a + y, b + x) contributes to a class through tap (r + HALO - STRIDE y, c + HALO - STRIDE x), if that
// is a tap.
//
// Weights are packed with input channels as lanes (conv2d_pack.cl). One work-item computes `tiles` tiles
// (conv2d_tile.clh) of each class, one after another; a tile's pixels are positions (a, b) of the output.
//
// -D: see conv2d.clh, conv2d_pack.cl, conv2d_tile.clh

// Largest and smallest y and x that reach a tap.
#define LAST ((HALO + STRIDE - 1) / STRIDE)
#define FIRST (-(HALO / STRIDE))

// With one class every (y, x) reaches a tap. With several, unrolling all rows makes is_tap() a compile-time constant.
#if STRIDE == 1
#define EACH_CLASS(F) F(0, 0)
#define UNROLLED_ROWS 1
#else
#define EACH_CLASS(F) F(0, 0) F(0, 1) F(1, 0) F(1, 1)
#define UNROLLED_ROWS (LAST - FIRST + 1)
#endif

static bool is_tap(int i) { return i >= 0 && i < KERNEL; }

static pixel_pointers outputs_of(__global const real* grad_out, int first, int pixels) {
  pixel_pointers from;
#define POINT(p) from.pixel##p = grad_out + out_offset(min(first + p, pixels - 1));
  REPEAT(PIXELS, POINT)
#undef POINT
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
    const size_t at = tap_offset(first + p) + IN_CORNER + r * IN_PITCH + c * IN_STEP; \
    EACH_BLOCK(STORE, p)                                                             \
  }
  REPEAT(PIXELS, STORE_PIXEL)
#undef STORE_PIXEL
#undef STORE
}

static void data_tiles(__global const real* restrict grad_out, __global const real* restrict weights,
                       __global const real* restrict in, __global real* restrict grad_in, int first,
                       int pixels) {
  const pixel_pointers from = outputs_of(grad_out, first, pixels);
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
