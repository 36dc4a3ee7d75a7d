// Weights of winograd.clh from parameters [out][in][3][3].
//
//   weights [set][row][lane] = G' w G, with G the 5 x 2 matrix of the even-numbered inputs, and 1 for the middle tap
//
// Rows are input channels and lanes output channels for the forward pass, the reverse for the gradient with respect to
// the input. In the parameters rows are row_step apart and lanes lane_step.
//
// -D: see winograd.clh

// Transforms 3 taps, `step` apart in `w`, to 6 values, `set_step` apart in `set`.
static void taps_to_sets(const real16* w, int step, real16* set, int set_step) {
  const real16 w0 = w[0] / 2, w1 = w[step], w2 = w[2 * step] / 2;
  set[0] = w0;
  set[set_step] = -w0 - w2;
  set[2 * set_step] = (w2 - w0) / 3;
  set[3 * set_step] = (w0 + 2 * w2) / 3;
  set[4 * set_step] = 2 * w2;
  set[5 * set_step] = w1;
}

// One work-item per 16 lanes of one row, for every set.
__kernel void winograd_weights(__global const real* restrict parameters, int weight_at, int row_step,
                               int lane_step, __global real* restrict weights) {
  const int block = get_global_id(0), row = get_global_id(1), lanes = get_global_size(0) * 16;
  __global const real* from = parameters + weight_at + row * row_step + block * 16 * lane_step;
  real16 w[9], rows[18], set[WEIGHT_SETS];
  for (int tap = 0; tap < 9; ++tap) {
    real values[16];
    for (int lane = 0; lane < 16; ++lane) values[lane] = from[lane * lane_step + tap];
    w[tap] = vload16(0, values);
  }
  for (int i = 0; i < 3; ++i) taps_to_sets(w + 3 * i, 1, rows + 6 * i, 1);
  for (int j = 0; j < 6; ++j) taps_to_sets(rows + j, 6, set + j, 6);
  for (int s = 0; s < WEIGHT_SETS; ++s)
    store16(set[s], block, weights + ((size_t)s * get_global_size(1) + row) * lanes);
}
