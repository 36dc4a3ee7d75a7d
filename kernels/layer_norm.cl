// LayerNorm over rows of COLUMNS values (Ba et al. 2016) and its gradient. One work-item per row.
//
//   y = gain (x - mean) / sigma + bias,  sigma = sqrt(variance + 1e-5)
//   statistics[row] = {mean, 1 / sigma}
//
// The mean is corrected by that of the deviations from it (Chan, Golub, LeVeque 1983, equation 1.7): an error of its last
// bit, divided by a sigma of 0.003, would be large where the values of a row are equal.
//
// -D COLUMNS: multiple of 16, no default
// -D EXACT: the sums over a row's vectors, and over rows in layer_norm_weights, are compensated
#define VECTORS (COLUMNS / 16)

// Sum of the 16 elements.
static real element_sum(real16 v) {
  const real8 a = v.lo + v.hi;
  const real4 b = a.lo + a.hi;
  return b.x + b.y + b.z + b.w;
}

__kernel void layer_norm(__global const real* x, __global const real* parameters, int gain_at,
                         int bias_at, __global real* y, __global real* statistics) {
  const size_t row = get_global_id(0);
  x += row * COLUMNS, y += row * COLUMNS;
  real16 sum = 0, squares = 0, sum_compensation = 0, squares_compensation = 0;
  for (int i = 0; i < VECTORS; ++i) ADD_TO(real16, sum, sum_compensation, vload16(i, x))
  real mean = element_sum(sum) / COLUMNS;
  sum = 0, sum_compensation = 0;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 d = vload16(i, x) - mean;
    ADD_TO(real16, sum, sum_compensation, d)
    ADD_PRODUCT(real16, squares, squares_compensation, d, d)
  }
  const real correction = element_sum(sum) / COLUMNS;
  const real scale = rsqrt(element_sum(squares) / COLUMNS - correction * correction + (real)1e-5);
  mean += correction;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 normal = (vload16(i, x) - mean) * scale;
    store16(fma(normal, vload16(i, parameters + gain_at), vload16(i, parameters + bias_at)), i, y);
  }
  statistics[2 * row] = mean, statistics[2 * row + 1] = scale;
}

//   dx = (g - mean(g) - n mean(g n)) / sigma,  g = gain dy,  n = (x - mean) / sigma
__kernel void layer_norm_backward(__global const real* dy, __global const real* x,
                                  __global const real* statistics, __global const real* parameters,
                                  int gain_at, __global real* dx) {
  const size_t row = get_global_id(0);
  dy += row * COLUMNS, x += row * COLUMNS, dx += row * COLUMNS;
  const real mean = statistics[2 * row], scale = statistics[2 * row + 1];
  real16 sum = 0, product = 0, sum_compensation = 0, product_compensation = 0;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 g = vload16(i, dy) * vload16(i, parameters + gain_at);
    const real16 normal = (vload16(i, x) - mean) * scale;
    ADD_TO(real16, sum, sum_compensation, g)
    ADD_PRODUCT(real16, product, product_compensation, g, normal)
  }
  const real mean_g = element_sum(sum) / COLUMNS, mean_gn = element_sum(product) / COLUMNS;
  for (int i = 0; i < VECTORS; ++i) {
    const real16 g = vload16(i, dy) * vload16(i, parameters + gain_at);
    const real16 normal = (vload16(i, x) - mean) * scale;
    store16((g - mean_g - normal * mean_gn) * scale, i, dx);
  }
}

//   dgain = sum over rows of dy n,  dbias = sum over rows of dy. One work-item per 16 columns.
__kernel void layer_norm_weights(__global const real* dy, __global const real* x,
                                 __global const real* statistics, int rows, __global real* gradient,
                                 int gain_at, int bias_at) {
  const int n = get_global_id(0);
  real16 gain = 0, bias = 0, gain_compensation = 0, bias_compensation = 0;
  for (int row = 0; row < rows; ++row) {
    const real16 d = vload16(n, dy + (size_t)row * COLUMNS);
    const real16 v = vload16(n, x + (size_t)row * COLUMNS);
    const real16 normal = (v - statistics[2 * row]) * statistics[2 * row + 1];
    ADD_TO(real16, gain, gain_compensation, d * normal)
    ADD_TO(real16, bias, bias_compensation, d)
  }
  store16(gain, n, gradient + gain_at);
  store16(bias, n, gradient + bias_at);
}
