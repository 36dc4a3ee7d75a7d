// Roll-out of a GRU on CPUs (Cho et al. 2014, reset gate as in PyTorch's GRUCell). One work-item advances four
// sequences through all steps. With sigma the logistic function and i = input_projection:
//
//   r = sigma(i_r + Wr s + Ur h + br),  z = sigma(i_z + Wz s + Uz h + bz),  a = Un h + bn
//   n = tanh(i_n + Wn s + r a),  h' = n + z (h - n),  then rollout_output.clh with h = h'
//
// input_projection is the part of W's products that does not depend on the state (bias and embedding), computed outside
// of the loop, as r | z | n. Rows are ordered [step][sequence].
//   states, spread, w3, b3: as in rollout.cl; h [steps + 1][S][HIDDEN], the first S rows given
//   input_projection [steps][S] rows, input_projection_ld apart (0: one row for all)
//   gates [steps][S] rows of r | z | n | a, GATES_ROW apart: rows 4 KiB apart would map to few cache sets
//   w [STATE] and u [HIDDEN] rows as [input][output], WEIGHTS_ROW apart; bias [3 HIDDEN] at bias_at
//
// -D HIDDEN, STATE: see dynamics.clh
#define GATES_ROW (4 * HIDDEN + 16)
#define WEIGHTS_ROW (3 * HIDDEN + 16)

static real16 logistic(real16 x) { return 1 / (1 + exp(-x)); }

static wide_tile logistic_of(wide_tile t) {
#define LOGISTIC(r)                                                       \
  t.a##r##0 = logistic(t.a##r##0), t.a##r##1 = logistic(t.a##r##1); \
  t.a##r##2 = logistic(t.a##r##2), t.a##r##3 = logistic(t.a##r##3);
  ROWS(LOGISTIC)
#undef LOGISTIC
  return t;
}

// Adds the same 64 values to all rows.
static wide_tile plus_row(wide_tile t, __global const real* row) {
#define PLUS(r)                                               \
  t.a##r##0 += vload16(0, row), t.a##r##1 += vload16(1, row); \
  t.a##r##2 += vload16(2, row), t.a##r##3 += vload16(3, row);
  ROWS(PLUS)
#undef PLUS
  return t;
}

// Columns n to n + 63 of the gates r | z.
static wide_tile gate(row_pointers input_projection, row_pointers now, row_pointers h, __global const real* w,
                      __global const real* u, __global const real* bias, int n) {
  wide_tile t = plus_row(load_wide(shifted(input_projection, n)), bias + n);
  t = multiply_wide(t, now, 1, w + n, WEIGHTS_ROW, STATE);
  return logistic_of(multiply_wide(t, h, 1, u + n, WEIGHTS_ROW, HIDDEN));
}

// Writes columns n to n + 63 of gate n and of h'. `t`: pre-activation of gate n without r a.
static void store_hidden_state(wide_tile t, row_pointers h, int n, __global real* gates, __global real* next,
                               int s, int sequences) {
#define STORE_LANES(r, c)                                                                    \
  {                                                                                          \
    const real16 candidate = tanh(fma(vload16(c, row), vload16(c, row + 3 * HIDDEN), t.a##r##c)); \
    store16(candidate, c, row + 2 * HIDDEN);                                                \
    const real16 change = vload16(c, h.x##r + n) - candidate;                                \
    store16(fma(vload16(c, row + HIDDEN), change, candidate), c, next + SEQUENCE(r) * HIDDEN + n); \
  }
#define STORE(r)                                             \
  {                                                          \
    __global real* row = gates + SEQUENCE(r) * GATES_ROW + n; \
    STORE_LANES(r, 0) STORE_LANES(r, 1) STORE_LANES(r, 2) STORE_LANES(r, 3) \
  }
  ROWS(STORE)
#undef STORE
#undef STORE_LANES
}

// One step: writes the gates and the next hidden state.
static void cell(row_pointers input_projection, row_pointers now, row_pointers h, __global const real* w,
                 __global const real* u, __global const real* bias, __global real* gates,
                 __global real* next, int s, int sequences) {
  for (int n = 0; n < 2 * HIDDEN; n += 64)
    store_sequences(gate(input_projection, now, h, w, u, bias, n), gates + n, GATES_ROW, s, sequences);
  for (int n = 0; n < HIDDEN; n += 64) {
    const int out = 2 * HIDDEN + n;
    const wide_tile a = multiply_wide(plus_row(zero_wide(), bias + out), h, 1, u + out, WEIGHTS_ROW, HIDDEN);
    store_sequences(a, gates + 3 * HIDDEN + n, GATES_ROW, s, sequences);
    const wide_tile t = multiply_wide(load_wide(shifted(input_projection, out)), now, 1, w + out, WEIGHTS_ROW, STATE);
    store_hidden_state(t, h, n, gates, next, s, sequences);
  }
}

__kernel void gru_rollout(__global real* states, __global real* h, __global const real* input_projection,
                          int input_projection_at, int input_projection_ld, __global const real* w,
                          __global const real* u,
                          __global const real* parameters, int bias_at, __global const real* w3,
                          __global const real* b3, __global real* gates, __global real* spread,
                          int sequences, int steps) {
  const int s = get_global_id(0) * 4;
  input_projection += input_projection_at;
  for (int t = 0; t < steps; ++t) {
    const row_pointers now = rows_of(states, 16, s, sequences), before = rows_of(h, HIDDEN, s, sequences);
    states += sequences * 16, h += sequences * HIDDEN;
    cell(rows_of(input_projection, input_projection_ld, s, sequences), now, before, w, u, parameters + bias_at, gates,
         h, s, sequences);
    output_layer(rows_of(h, HIDDEN, s, sequences), w3, b3, now, states, spread, s, sequences);
    input_projection += (size_t)sequences * input_projection_ld;
    gates += (size_t)sequences * GATES_ROW, spread += sequences * 16;
  }
}
