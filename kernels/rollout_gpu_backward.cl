// GPU variant of rollout_backward.cl; equations and arrays: there.

__kernel WORK_GROUP_ATTRIBUTE void rollout_gpu_backward(
    __global const real* grad_state, __global const real* grad_spread, __global const real* spread,
    __global const real* y1, __global const real* y2, __global const real* parameters, int w2_at,
    int w3_at, __global const real* w1, __global real* d_out, __global real* d_h1, __global real* d_h2,
    int sequences, int steps) {
  __local real4 d_delta[16], d_band[16], d2[HIDDEN], d1[HIDDEN], slices[WORK_GROUP_SIZE], partial[SLICES * HIDDEN];
  const int item = get_local_id(0);
  const int4 sequence = sequences_of(sequences);
  __global const real* w2 = parameters + w2_at;
  __global const real* w3 = parameters + w3_at;
  real4 carry = 0;  // of state element `item`
  for (int t = steps - 1; t >= 0; --t) {
    const int4 rows = t * sequences + sequence;
    if (item < 16) {
      carry += load_rows(grad_state, rows, 16, item);
      store_rows(d_delta[item] = carry, d_out, rows, 32, item);
    } else if (item < 32) {
      const real4 slope = -expm1(-load_rows(spread, rows, 16, item - 16));
      d_band[item - 16] = load_rows(grad_spread, rows, 16, item - 16) * slope;
      store_rows(d_band[item - 16], d_out, rows, 32, item);
    }
    BARRIER
    EACH_UNIT(n) {
      real4 sum = multiply_column((real4)(0), d_delta, w3, HIDDEN, n, STATE);
      sum = multiply_column(sum, d_band, w3 + STATE * HIDDEN, HIDDEN, n, STATE);
      store_rows(d2[n] = ACTIVATE_BACKWARD(sum, load_rows(y2, rows, HIDDEN, n)), d_h2, rows, HIDDEN, n);
    }
    BARRIER
    multiply_hidden(partial, d2, w2);
    BARRIER
    EACH_UNIT(n) {
      const real4 sum = unit_total((real4)(0), partial, n);
      store_rows(d1[n] = ACTIVATE_BACKWARD(sum, load_rows(y1, rows, HIDDEN, n)), d_h1, rows, HIDDEN, n);
    }
    BARRIER
    sum_slices(slices, d1, w1, 16);
    BARRIER
    if (item < 16) carry += total_of(slices, 16, item);
  }
}
