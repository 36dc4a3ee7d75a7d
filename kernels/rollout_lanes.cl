// GPUs' body of rollout.cl, which gives the equations and the arrays.

static real4 softplus(real4 x) { return fmax(x, (real4)(0)) + log1p(exp(-fabs(x))); }

__kernel IN_GROUPS void rollout_lanes(
    __global real* states, __global const real* first, int first_at, int first_ld,
    __global const real* parameters, int b2_at, __global const real* w1, __global const real* w2,
    __global const real* w3, __global const real* b3, __global real* h1, __global real* h2,
    __global real* sum1, __global real* sum2, __global real* spread, int sequences, int steps) {
  __local real4 state[16], x1[HIDDEN], x2[HIDDEN], slices[GROUP];
  const int lane = get_local_id(0);
  const int4 rows = sequences_of(sequences);
  if (lane < 16) state[lane] = load_rows(states, rows, 16, lane);
  first += first_at;
  for (int t = 0; t < steps; ++t) {
    WAIT
    EACH_UNIT(n) {
      const real4 sum = multiply_column(load_rows(first, rows, first_ld, n), state, w1, HIDDEN, n, STATE);
      if (SLOPE_FROM_SUM) store_rows(sum, sum1, rows, HIDDEN, n);
      store_rows(x1[n] = ACTIVATE(sum), h1, rows, HIDDEN, n);
    }
    WAIT
    EACH_UNIT(n) {
      const real4 sum = multiply_column((real4)(parameters[b2_at + n]), x1, w2, HIDDEN, n, HIDDEN);
      if (SLOPE_FROM_SUM) store_rows(sum, sum2, rows, HIDDEN, n);
      store_rows(x2[n] = ACTIVATE(sum), h2, rows, HIDDEN, n);
    }
    WAIT
    sum_slices(slices, x2, w3, 32);
    WAIT
    states += sequences * 16;
    if (lane < 16) {
      state[lane] += b3[lane] + total_of(slices, 32, lane);
      store_rows(state[lane], states, rows, 16, lane);
    } else if (lane < 32) {
      store_rows(softplus(b3[lane] + total_of(slices, 32, lane)), spread, rows, 16, lane - 16);
    }
    first += (size_t)sequences * first_ld;
    h1 += sequences * HIDDEN, h2 += sequences * HIDDEN, spread += sequences * 16;
    if (SLOPE_FROM_SUM) sum1 += sequences * HIDDEN, sum2 += sequences * HIDDEN;
  }
}
