// Roll-out of the dynamics MLP on CPUs (equation 1). One work-item advances four sequences through all steps.
//
//   h1 = act(input_projection + W1 s),  h2 = act(W2 h1 + b2),  then rollout_output.clh with h = h2
//
// Rows are ordered [step][sequence].
//   states [steps + 1][S][16]: the first S rows are the initial states, the others are written
//   input_projection [steps][S] rows, input_projection_ld apart (0: one row for all): bias and embedding part of layer
//     1, which do not depend on the state and are computed outside of the loop
//   h1, h2 [steps][S][HIDDEN]; spread [steps][S][16]
//   pre_activation1, pre_activation2: as h1, h2; written only if the activation's slope needs them
//   w1 [STATE][HIDDEN], w2 [HIDDEN][HIDDEN] as [input][output]
//   w3 [HIDDEN][32], b3 [32] as delta | band, each zero-padded from STATE to 16
//
// -D HIDDEN, STATE, ACTIVATION: see dynamics.clh

static wide_tile activated(wide_tile t) {
#define ACTIVATE_ROW(r)                                                     \
  t.a##r##0 = ACTIVATE(t.a##r##0), t.a##r##1 = ACTIVATE(t.a##r##1); \
  t.a##r##2 = ACTIVATE(t.a##r##2), t.a##r##3 = ACTIVATE(t.a##r##3);
  ROWS(ACTIVATE_ROW)
#undef ACTIVATE_ROW
  return t;
}

// Writes act(start + x w), [4][HIDDEN], to the sequences' rows of h, and the pre-activation to those of `sum`.
static void hidden_layer(row_pointers x, int count, __global const real* w, row_pointers start,
                         __global real* h, __global real* sum, int s, int sequences) {
  for (int n = 0; n < HIDDEN; n += 64) {
    const wide_tile t = multiply_wide(load_wide(shifted(start, n)), x, 1, w + n, HIDDEN, count);
    if (SLOPE_FROM_SUM) store_sequences(t, sum + n, HIDDEN, s, sequences);
    store_sequences(activated(t), h + n, HIDDEN, s, sequences);
  }
}

__kernel void rollout(__global real* states, __global const real* input_projection, int input_projection_at,
                      int input_projection_ld,
                      __global const real* parameters, int b2_at, __global const real* w1,
                      __global const real* w2, __global const real* w3, __global const real* b3,
                      __global real* h1, __global real* h2, __global real* pre_activation1,
                      __global real* pre_activation2,
                      __global real* spread, int sequences, int steps) {
  const int s = get_global_id(0) * 4;
  const row_pointers b2 = rows_of(parameters + b2_at, 0, 0, 1);
  input_projection += input_projection_at;
  for (int t = 0; t < steps; ++t) {
    const row_pointers now = rows_of(states, 16, s, sequences);
    states += sequences * 16;
    hidden_layer(now, STATE, w1, rows_of(input_projection, input_projection_ld, s, sequences), h1, pre_activation1, s,
                 sequences);
    hidden_layer(rows_of(h1, HIDDEN, s, sequences), HIDDEN, w2, b2, h2, pre_activation2, s, sequences);
    output_layer(rows_of(h2, HIDDEN, s, sequences), w3, b3, now, states, spread, s, sequences);
    input_projection += (size_t)sequences * input_projection_ld;
    h1 += sequences * HIDDEN, h2 += sequences * HIDDEN, spread += sequences * 16;
    pre_activation1 += sequences * HIDDEN, pre_activation2 += sequences * HIDDEN;
  }
}
