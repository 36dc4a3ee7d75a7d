// Gradient of conv2d.clh towards its input, which must stand in blocks.
//
// A gather by parity: the input pixels (2a, 2b), (2a, 2b+1), (2a+1, 2b), (2a+1, 2b+1), a "quad", get
// 1, 2, 2 and 4 taps from the output pixels (a, b), (a, b+1), (a+1, b), (a+1, b+1). So nothing is added
// twice and there are no atomics. The mask of the ReLU that made the input is applied at once:
//
//   grad_in[c][y][x] = [in[c][y][x] > 0] sum_{k, taps} weight[k][c][i][j] grad_out[k][..][..]
//
// Weights are packed with input channels as lanes, summed over output channels. A work-item computes
// `tiles` tiles of QUADS quads, counted through all images, times 32 input channels.
//
// -D BLOCKS=2. QUADS: 8 accumulators each.
#define QUADS 3

static void store_masked(real16 value, __global const real* in, __global real* grad_in) {
  vstore16(select((real16)(0), value, vload16(0, in) > (real16)(0)), 0, grad_in);
}

static void data_tile(__global const real* restrict grad_out, __global const real* restrict weights,
                      __global const real* restrict in, __global real* restrict grad_in, int first,
                      int quads) {
#define START(q)                                                                \
  __global const real* out##q = grad_out + out_place(min(first + q, quads - 1)); \
  real16 ee0_##q = 0, ee1_##q = 0, eo0_##q = 0, eo1_##q = 0;                    \
  real16 oe0_##q = 0, oe1_##q = 0, oo0_##q = 0, oo1_##q = 0;
  REPEAT(QUADS, START)
#undef START
  for (int block = 0; block < OUT_CHANNELS / 16; ++block)
    for (int lane = 0; lane < 16; ++lane) {
      const int channel_at = block * OUT_BLOCK + lane;
#define ADD(class, q)                                 \
  {                                                   \
    const real16 g = (real16)(out##q[at]);            \
    class##0_##q = fma(g, weight0, class##0_##q);     \
    class##1_##q = fma(g, weight1, class##1_##q);     \
  }
#define ADD_ee(q) ADD(ee, q)
#define ADD_eo(q) ADD(eo, q)
#define ADD_oe(q) ADD(oe, q)
#define ADD_oo(q) ADD(oo, q)
// One tap for all quads: the parity that it feeds, its place in the weight, and which output pixel it
// reads, relative to (a, b).
#define TAP(class, i, j, a, b)                                     \
  {                                                                \
    const int at = channel_at + a * OUT_PITCH + b * OUT_STEP;      \
    const real16 weight0 = vload16((3 * i + j) * 2, weights);      \
    const real16 weight1 = vload16((3 * i + j) * 2 + 1, weights);  \
    REPEAT(QUADS, ADD_##class)                                     \
  }
      TAP(ee, 1, 1, 0, 0)
      TAP(eo, 1, 0, 0, 1) TAP(eo, 1, 2, 0, 0)
      TAP(oe, 0, 1, 1, 0) TAP(oe, 2, 1, 0, 0)
      TAP(oo, 0, 0, 1, 1) TAP(oo, 0, 2, 1, 0) TAP(oo, 2, 0, 0, 1) TAP(oo, 2, 2, 0, 0)
#undef TAP
      weights += CHANNEL_SIZE;
    }
#define STORE_PIXEL(class, q, i, j)                                    \
  {                                                                    \
    const size_t at = place + i * IN_PITCH + j * IN_STEP;              \
    store_masked(class##0_##q, in + at, grad_in + at);                 \
    store_masked(class##1_##q, in + at + IN_BLOCK, grad_in + at + IN_BLOCK); \
  }
#define STORE(q)                                                              \
  if (first + q < quads) {                                                    \
    const size_t place = tap_place(first + q) + IN_CORNER;                    \
    const bool right = 2 * ((first + q) % OUT_COLS) + 1 < IN_COLS;            \
    const bool below = 2 * ((first + q) % OUT_AREA / OUT_COLS) + 1 < IN_ROWS; \
    STORE_PIXEL(ee, q, 0, 0)                                                  \
    if (right) STORE_PIXEL(eo, q, 0, 1)                                       \
    if (below) STORE_PIXEL(oe, q, 1, 0)                                       \
    if (right && below) STORE_PIXEL(oo, q, 1, 1)                              \
  }
  REPEAT(QUADS, STORE)
#undef STORE
}

__kernel void conv2d_backward_data(__global const real* restrict grad_out,
                                   __global const real* restrict packed,
                                   __global const real* restrict in, __global real* restrict grad_in,
                                   int images, int tiles) {
  const int pair = get_global_id(1), quads = images * OUT_AREA;
  const int begin = get_global_id(0) * tiles * QUADS, end = min(begin + tiles * QUADS, quads);
  for (int first = begin; first < end; first += QUADS)
    data_tile(grad_out, packed + pair * OUT_CHANNELS * CHANNEL_SIZE, in + pair * 2 * IN_BLOCK,
              grad_in + pair * 2 * IN_BLOCK, first, quads);
}
