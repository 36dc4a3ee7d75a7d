// GPU variant of rollout.cl; equations and arrays: there.

__kernel WORK_GROUP_ATTRIBUTE void rollout_gpu(
    __global real* states, __global const real* input_projection, int input_projection_at, int input_projection_ld,
    __global const real* parameters, int b2_at, __global const real* w1, __global const real* w2,
    __global const real* w3, __global const real* b3, __global real* h1, __global real* h2,
    __global real* pre_activation1, __global real* pre_activation2, __global real* spread, int sequences, int steps) {
  __local real4 state[16], x1[HIDDEN], x2[HIDDEN], slices[WORK_GROUP_SIZE];
  const int item = get_local_id(0);
  const int4 rows = sequences_of(sequences);
  if (item < 16) state[item] = load_rows(states, rows, 16, item);
  input_projection += input_projection_at;
  for (int t = 0; t < steps; ++t) {
    BARRIER
    EACH_UNIT(n) {
      const real4 start = load_rows(input_projection, rows, input_projection_ld, n);
      const real4 sum = multiply_column(start, state, w1, HIDDEN, n, STATE);
      if (SLOPE_FROM_SUM) store_rows(sum, pre_activation1, rows, HIDDEN, n);
      store_rows(x1[n] = ACTIVATE(sum), h1, rows, HIDDEN, n);
    }
    BARRIER
    EACH_UNIT(n) {
      const real4 sum = multiply_column((real4)(parameters[b2_at + n]), x1, w2, HIDDEN, n, HIDDEN);
      if (SLOPE_FROM_SUM) store_rows(sum, pre_activation2, rows, HIDDEN, n);
      store_rows(x2[n] = ACTIVATE(sum), h2, rows, HIDDEN, n);
    }
    BARRIER
    sum_slices(slices, x2, w3, 32);
    BARRIER
    states += sequences * 16;
    write_output(state, slices, b3, states, spread, rows);
    input_projection += (size_t)sequences * input_projection_ld;
    h1 += sequences * HIDDEN, h2 += sequences * HIDDEN, spread += sequences * 16;
    if (SLOPE_FROM_SUM) pre_activation1 += sequences * HIDDEN, pre_activation2 += sequences * HIDDEN;
  }
}
