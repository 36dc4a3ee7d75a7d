// GPU variant of gru_rollout.cl; equations and arrays: there. A work-group advances four sequences (rollout_gpu.clh).
#define GATES_ROW (4 * HIDDEN + 16)
#define WEIGHTS_ROW (3 * HIDDEN + 16)

static real4 logistic(real4 x) { return 1 / (1 + exp(-x)); }

__kernel WORK_GROUP_ATTRIBUTE void gru_rollout_gpu(
    __global real* states, __global real* h, __global const real* input_projection, int input_projection_at,
    int input_projection_ld, __global const real* w, __global const real* u, __global const real* parameters,
    int bias_at, __global const real* w3, __global const real* b3, __global real* gates, __global real* spread,
    int sequences, int steps) {
  __local real4 state[16], hidden[2 * HIDDEN], slices[WORK_GROUP_SIZE];
  __local real4 *now = hidden, *next = hidden + HIDDEN;
  __global const real* bias = parameters + bias_at;
  const int item = get_local_id(0);
  const int4 rows = sequences_of(sequences);
  if (item < 16) state[item] = load_rows(states, rows, 16, item);
  EACH_UNIT(n) now[n] = load_rows(h, rows, HIDDEN, n);
  input_projection += input_projection_at;
  for (int t = 0; t < steps; ++t) {
    BARRIER
    h += sequences * HIDDEN;
// Column `column` of i + W s, and of U h + b.
#define FROM_STATE(column) \
  multiply_column(load_rows(input_projection, rows, input_projection_ld, column), state, w, WEIGHTS_ROW, column, STATE)
#define FROM_HIDDEN(column) multiply_column((real4)(bias[column]), now, u, WEIGHTS_ROW, column, HIDDEN)
    EACH_UNIT(n) {
      const real4 r = logistic(FROM_STATE(n) + FROM_HIDDEN(n));
      const real4 z = logistic(FROM_STATE(HIDDEN + n) + FROM_HIDDEN(HIDDEN + n));
      const real4 a = FROM_HIDDEN(2 * HIDDEN + n);
      const real4 candidate = tanh(fma(r, a, FROM_STATE(2 * HIDDEN + n)));
      store_rows(r, gates, rows, GATES_ROW, n);
      store_rows(z, gates, rows, GATES_ROW, HIDDEN + n);
      store_rows(candidate, gates, rows, GATES_ROW, 2 * HIDDEN + n);
      store_rows(a, gates, rows, GATES_ROW, 3 * HIDDEN + n);
      store_rows(next[n] = fma(z, now[n] - candidate, candidate), h, rows, HIDDEN, n);
    }
    BARRIER
    sum_slices(slices, next, w3, 32);
    BARRIER
    states += sequences * 16;
    write_output(state, slices, b3, states, spread, rows);
    __local real4* before = now;
    now = next, next = before;
    input_projection += (size_t)sequences * input_projection_ld;
    gates += (size_t)sequences * GATES_ROW, spread += sequences * 16;
  }
}
