// Forward pass of conv2d.clh. A work-item computes `tiles` tiles one after the other: PIXELS output
// pixels, counted through all images in one row, times BLOCKS blocks of 16 output channels, in
// individually named accumulators, since an array of them would leave the registers.
//
// -D BLOCKS=2 or 4 (4 needs fewer loads for a multiplication). PIXELS follows: 24 accumulators, of the
// 32 registers of AVX-512.
#define PIXELS JOIN(PIXELS_OF_, BLOCKS)
#define PIXELS_OF_2 12
#define PIXELS_OF_4 6

#if BLOCKS == 4
#define EACH_BLOCK(F, p) F(0, p) F(1, p) F(2, p) F(3, p)
#else
#define EACH_BLOCK(F, p) F(0, p) F(1, p)
#endif

typedef struct {
#define FIELD(b, p) real16 sum##b##_##p;
#define FIELDS(p) EACH_BLOCK(FIELD, p)
  REPEAT(PIXELS, FIELDS)
#undef FIELDS
#undef FIELD
} tile;

typedef struct {
#define FIELD(p) __global const real* pixel##p;
  REPEAT(PIXELS, FIELD)
#undef FIELD
} places;

// A tile of which every pixel starts from the same TAP_SIZE values.
static tile start_tile(const __global real* from) {
  tile t;
#define START(b, p) t.sum##b##_##p = vload16(b, from);
#define START_PIXEL(p) EACH_BLOCK(START, p)
  REPEAT(PIXELS, START_PIXEL)
#undef START_PIXEL
#undef START
  return t;
}

// tile[pixel][lane] += from[pixel][at] weights[lane]
static tile add_tap(tile t, places from, int at, __global const real* weights) {
#define LOAD(b, p) const real16 weight##b = vload16(b, weights);
  EACH_BLOCK(LOAD, 0)
#undef LOAD
#define ADD(b, p) t.sum##b##_##p = fma(value, weight##b, t.sum##b##_##p);
#define ADD_PIXEL(p)                                     \
  {                                                      \
    const real16 value = (real16)(from.pixel##p[at]);    \
    EACH_BLOCK(ADD, p)                                   \
  }
  REPEAT(PIXELS, ADD_PIXEL)
#undef ADD_PIXEL
#undef ADD
  return t;
}

static places taps_of(__global const real* in, int first, int pixels) {
  places from;
#define PLACE(p) from.pixel##p = in + tap_place(min(first + p, pixels - 1));
  REPEAT(PIXELS, PLACE)
#undef PLACE
  return from;
}

static tile convolve(tile t, places from, __global const real* weights) {
  for (int block = 0; block < IN_BLOCKS; ++block)
    for (int lane = 0; lane < IN_LANES; ++lane) {
      const int at = block * IN_BLOCK + lane * IN_LANE;
#define TAP(i, j) t = add_tap(t, from, at + i * IN_PITCH + j * IN_STEP, weights + (3 * i + j) * TAP_SIZE);
      TAP(0, 0) TAP(0, 1) TAP(0, 2) TAP(1, 0) TAP(1, 1) TAP(1, 2) TAP(2, 0) TAP(2, 1) TAP(2, 2)
#undef TAP
      weights += CHANNEL_SIZE;
    }
  return t;
}

static void store_activations(tile t, __global real* out, int first, int pixels) {
#define STORE(b, p) vstore16(max(t.sum##b##_##p, (real16)(0)), 0, to + b * OUT_BLOCK);
#define STORE_PIXEL(p)                              \
  if (first + p < pixels) {                         \
    __global real* to = out + out_place(first + p); \
    EACH_BLOCK(STORE, p)                            \
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
    const tile bias = start_tile(parameters + bias_at + group * TAP_SIZE);
    store_activations(convolve(bias, taps_of(in, first, pixels), packed), out, first, pixels);
  }
}
