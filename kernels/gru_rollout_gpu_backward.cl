// GPU variant of gru_rollout_backward.cl; equations and arrays: there. d_h stays in local memory.

// sum + the work-item's slice of sum_k x[k] w[k][column] over the hidden units for 16 columns (sum_slices()).
static real4 add_slice(real4 sum, __local const real4* x, __global const real* w) {
  const int slice = get_local_id(0) / 16, step = WORK_GROUP_SIZE / 16;
  return weighted_sum(sum, x + slice, step, w + get_local_id(0), WORK_GROUP_SIZE, HIDDEN / step);
}

__kernel WORK_GROUP_ATTRIBUTE void gru_rollout_gpu_backward(
    __global const real* grad_state, __global const real* grad_spread, __global const real* spread,
    __global const real* h, __global const real* gates, __global const real* parameters, int u_at, int w3_at,
    __global const real* w, __global real* d_out, __global real* d_gates, int sequences, int steps) {
  __local real4 d_delta[16], d_band[16], slices[WORK_GROUP_SIZE];
  __local real4 d_r[HIDDEN], d_z[HIDDEN], d_n[HIDDEN], d_a[HIDDEN], d_h[HIDDEN];
  __global const real *u = parameters + u_at, *w3 = parameters + w3_at;
  const int item = get_local_id(0);
  const int4 sequence = sequences_of(sequences);
  real4 carry = 0;  // of state element `item`
  EACH_UNIT(n) d_h[n] = 0;
  for (int t = steps - 1; t >= 0; --t) {
    const int4 rows = t * sequences + sequence;
    carry = output_gradient(carry, grad_state, grad_spread, spread, d_delta, d_band, d_out, rows);
    BARRIER
    EACH_UNIT(n) {
      const real4 d = output_layer_backward(d_h[n], d_delta, d_band, w3, n);
      const real4 r = load_rows(gates, rows, GATES_ROW, n), z = load_rows(gates, rows, GATES_ROW, HIDDEN + n);
      const real4 candidate = load_rows(gates, rows, GATES_ROW, 2 * HIDDEN + n);
      const real4 a = load_rows(gates, rows, GATES_ROW, 3 * HIDDEN + n), rest = 1 - z;
      d_n[n] = d * rest * fma(-candidate, candidate, (real4)(1));
      d_r[n] = d_n[n] * a * r * (1 - r);
      d_z[n] = d * (load_rows(h, rows, HIDDEN, n) - candidate) * z * rest;
      d_a[n] = d_n[n] * r;
      d_h[n] = d * z;
      store_rows(d_r[n], d_gates, rows, GATES_ROW, n);
      store_rows(d_z[n], d_gates, rows, GATES_ROW, HIDDEN + n);
      store_rows(d_n[n], d_gates, rows, GATES_ROW, 2 * HIDDEN + n);
      store_rows(d_a[n], d_gates, rows, GATES_ROW, 3 * HIDDEN + n);
    }
    BARRIER
    if (t == 0) return;  // the initial hidden state gets no gradient
    EACH_UNIT(n) {
      real4 sum = multiply_column(d_h[n], d_r, u, HIDDEN, n, HIDDEN);
      sum = multiply_column(sum, d_z, u + HIDDEN * HIDDEN, HIDDEN, n, HIDDEN);
      d_h[n] = multiply_column(sum, d_a, u + 2 * HIDDEN * HIDDEN, HIDDEN, n, HIDDEN);
    }
    slices[item] = add_slice(add_slice(add_slice((real4)(0), d_r, w), d_z, w + HIDDEN * 16), d_n, w + 2 * HIDDEN * 16);
    BARRIER
    if (item < 16) carry += total_of(slices, 16, item);
  }
}
