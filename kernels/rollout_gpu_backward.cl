// GPU variant of rollout_backward.cl; equations and arrays: there.

__kernel WORK_GROUP_ATTRIBUTE void rollout_gpu_backward(
    __global const real* grad_state, __global const real* grad_spread, __global const real* spread,
    __global const real* y1, __global const real* y2, __global const real* parameters, int w2_at,
    int w3_at, __global const real* w1, __global real* d_out, __global real* d_h1, __global real* d_h2,
    int sequences, int steps) {
  __local real4 d_delta[16], d_band[16], d2[HIDDEN], d1[HIDDEN], slices[WORK_GROUP_SIZE];
  const int item = get_local_id(0);
  const int4 sequence = sequences_of(sequences);
  __global const real* w2 = parameters + w2_at;
  __global const real* w3 = parameters + w3_at;
  real4 carry = 0;  // of state element `item`
  for (int t = steps - 1; t >= 0; --t) {
    const int4 rows = t * sequences + sequence;
    carry = output_gradient(carry, grad_state, grad_spread, spread, d_delta, d_band, d_out, rows);
    BARRIER
    EACH_UNIT(n) {
      const real4 sum = output_layer_backward((real4)(0), d_delta, d_band, w3, n);
      store_rows(d2[n] = ACTIVATE_BACKWARD(sum, load_rows(y2, rows, HIDDEN, n)), d_h2, rows, HIDDEN, n);
    }
    BARRIER
    EACH_UNIT(n) {
      const real4 sum = multiply_column((real4)(0), d2, w2, HIDDEN, n, HIDDEN);
      store_rows(d1[n] = ACTIVATE_BACKWARD(sum, load_rows(y1, rows, HIDDEN, n)), d_h1, rows, HIDDEN, n);
    }
    BARRIER
    sum_slices(slices, d1, w1, 16);
    BARRIER
    if (item < 16) carry += total_of(slices, 16, item);
  }
}
