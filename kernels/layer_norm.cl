// LayerNorm over rows of COLUMNS values, a multiple of 16 (Ba et al. 2016), and its gradient.
//
//   y = gain (x - mean) / deviation + bias,  deviation = sqrt(variance + 1e-5)
//   statistics[row] = {mean, 1 / deviation}
#define VECTORS (COLUMNS / 16)

static real lane_sum(real16 v) {
  const real8 a = v.lo + v.hi;
  const real4 b = a.lo + a.hi;
  return b.x + b.y + b.z + b.w;
}

__kernel void layer_norm(__global const real* x, __global const real* parameters, int gain_at,
                         int bias_at, __global real* y, __global real* statistics) {
  const size_t row = get_global_id(0);
  x += row * COLUMNS, y += row * COLUMNS;
  real16 sum = 0, squares = 0;
  for (int i = 0; i < VECTORS; ++i) sum += vload16(i, x);
  const real mean = lane_sum(sum) / COLUMNS;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 d = vload16(i, x) - mean;
    squares = fma(d, d, squares);
  }
  const real scale = rsqrt(lane_sum(squares) / COLUMNS + (real)1e-5);
  for (int i = 0; i < VECTORS; ++i) {
    const real16 normal = (vload16(i, x) - mean) * scale;
    store16(fma(normal, vload16(i, parameters + gain_at), vload16(i, parameters + bias_at)), i, y);
  }
  statistics[2 * row] = mean, statistics[2 * row + 1] = scale;
}

//   dx = (g - mean(g) - n mean(g n)) / deviation,  g = gain dy,  n = (x - mean) / deviation
__kernel void layer_norm_backward(__global const real* dy, __global const real* x,
                                  __global const real* statistics, __global const real* parameters,
                                  int gain_at, __global real* dx) {
  const size_t row = get_global_id(0);
  dy += row * COLUMNS, x += row * COLUMNS, dx += row * COLUMNS;
  const real mean = statistics[2 * row], scale = statistics[2 * row + 1];
  real16 sum = 0, product = 0;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 g = vload16(i, dy) * vload16(i, parameters + gain_at);
    sum += g;
    product = fma(g, (vload16(i, x) - mean) * scale, product);
  }
  const real mean_g = lane_sum(sum) / COLUMNS, mean_gn = lane_sum(product) / COLUMNS;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 g = vload16(i, dy) * vload16(i, parameters + gain_at);
    const real16 normal = (vload16(i, x) - mean) * scale;
    store16((g - mean_g - normal * mean_gn) * scale, i, dx);
  }
}

//   dgain = sum over rows of dy n,  dbias = sum over rows of dy; one work-item 16 columns
__kernel void layer_norm_weights(__global const real* dy, __global const real* x,
                                 __global const real* statistics, int rows, __global real* gradient,
                                 int gain_at, int bias_at) {
  const int n = get_global_id(0);
  real16 gain = 0, bias = 0, lost_gain = 0, lost_bias = 0;
  for (int row = 0; row < rows; ++row) {
    const real16 d = vload16(n, dy + (size_t)row * COLUMNS);
    const real16 v = vload16(n, x + (size_t)row * COLUMNS);
    const real16 normal = (v - statistics[2 * row]) * statistics[2 * row + 1];
    ADD_TO(real16, gain, lost_gain, d * normal)
    ADD_TO(real16, bias, lost_bias, d)
  }
  store16(gain, n, gradient + gain_at);
  store16(bias, n, gradient + bias_at);
}
