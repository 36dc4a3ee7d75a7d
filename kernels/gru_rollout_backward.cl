// Back-propagation through time of gru_rollout.cl on CPUs. One work-item takes four sequences from the last step to the
// first. With carry(t) = dl/ds(t+1), and d h' the gradient from step t + 1 plus W3' (d delta, d band):
//
//   d n = d h' (1 - z) (1 - n^2),  d z = d h' (h - n) z (1 - z),  d a = d n r,  d r = d n a r (1 - r)
//   d h = d h' z + Ur' d r + Uz' d z + Un' d a
//   carry(t-1) = carry(t) + Wr' d r + Wz' d z + Wn' d n + grad_state(t-1)
//
//   grad_state, grad_spread, d_out: as in rollout_backward.cl; h, gates: as written by gru_rollout.cl
//   d_gates [steps][S] rows of d r | d z | d n | d a, with respect to the pre-activations, GATES_ROW apart
//   d_h [S][HIDDEN]: scratch
//   u [3 HIDDEN][HIDDEN] and w3 [2 STATE][HIDDEN] as [output][input] in `parameters`; w [3 HIDDEN][16], zero-padded
//
// The weight gradients are matrix products over all rows of these arrays (dense.cl).
//
// -D HIDDEN, STATE: see dynamics.clh

// From columns n to n + 63 of d h' writes those of d_gates, and d h' z to d_h.
static void cell_backward(wide_tile t, row_pointers h, row_pointers gates, int n, __global real* d_gates,
                          __global real* d_h, int s, int sequences) {
#define STORE_LANES(r_, c)                                                                         \
  {                                                                                                \
    const real16 r = vload16(c, gate), z = vload16(c, gate + HIDDEN), candidate = vload16(c, gate + 2 * HIDDEN); \
    const real16 d = t.a##r_##c, rest = 1 - z;                                                     \
    const real16 d_n = d * rest * fma(-candidate, candidate, (real16)(1));                         \
    store16(d_n * vload16(c, gate + 3 * HIDDEN) * r * (1 - r), c, to);                            \
    store16(d * (vload16(c, h.x##r_ + n) - candidate) * z * rest, c, to + HIDDEN);                \
    store16(d_n, c, to + 2 * HIDDEN);                                                             \
    store16(d_n * r, c, to + 3 * HIDDEN);                                                         \
    store16(d * z, c, d_h + SEQUENCE(r_) * HIDDEN + n);                                           \
  }
#define STORE(r)                                                  \
  {                                                               \
    TILE_MEMORY const real* gate = gates.x##r + n;                \
    __global real* to = d_gates + SEQUENCE(r) * GATES_ROW + n;    \
    STORE_LANES(r, 0) STORE_LANES(r, 1) STORE_LANES(r, 2) STORE_LANES(r, 3) \
  }
  ROWS(STORE)
#undef STORE
#undef STORE_LANES
}

// d_h += U' (d r, d z, d a).
static void hidden_state_backward(row_pointers d_gates, __global const real* u, __global real* d_h, int s,
                                  int sequences) {
  const row_pointers d_a = shifted(d_gates, 3 * HIDDEN), d_h_rows = rows_of(d_h, HIDDEN, s, sequences);
  for (int n = 0; n < HIDDEN; n += 64) {
    wide_tile t = load_wide(shifted(d_h_rows, n));
    t = multiply_wide(t, d_gates, 1, u + n, HIDDEN, 2 * HIDDEN);
    t = multiply_wide(t, d_a, 1, u + 2 * HIDDEN * HIDDEN + n, HIDDEN, HIDDEN);
    store_sequences(t, d_h + n, HIDDEN, s, sequences);
  }
}

__kernel void gru_rollout_backward(__global const real* grad_state, __global const real* grad_spread,
                                   __global const real* spread, __global const real* h,
                                   __global const real* gates, __global const real* parameters, int u_at,
                                   int w3_at, __global const real* w, __global real* d_out,
                                   __global real* d_gates, __global real* d_h, int sequences, int steps) {
  const int s = get_global_id(0) * 4;
  narrow_tile carry = fill_narrow((real16)(0));
  for (int n = 0; n < HIDDEN; n += 64) store_sequences(zero_wide(), d_h + n, HIDDEN, s, sequences);
  const row_pointers d_h_rows = rows_of(d_h, HIDDEN, s, sequences);
  for (int t = steps - 1; t >= 0; --t) {
    const size_t row = (size_t)t * sequences;
    carry = output_gradient(carry, grad_state, grad_spread, spread, d_out, row, s, sequences);
    const row_pointers d_out_now = rows_of(d_out + row * 32, 32, s, sequences);
    for (int n = 0; n < HIDDEN; n += 64)
      cell_backward(output_layer_backward(load_wide(shifted(d_h_rows, n)), d_out_now, parameters + w3_at, n),
                    rows_of(h + row * HIDDEN, HIDDEN, s, sequences),
                    rows_of(gates + row * GATES_ROW, GATES_ROW, s, sequences), n, d_gates + row * GATES_ROW,
                    d_h, s, sequences);
    if (t == 0) return;  // the initial hidden state gets no gradient
    const row_pointers d_now = rows_of(d_gates + row * GATES_ROW, GATES_ROW, s, sequences);
    hidden_state_backward(d_now, parameters + u_at, d_h, s, sequences);
    carry = multiply_narrow(carry, d_now, 1, w, 16, 3 * HIDDEN);
  }
}
