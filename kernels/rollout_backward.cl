// Back-propagation through time of rollout.cl on CPUs. One work-item takes four sequences from the last step to the
// first. With l the loss and carry(t) = dl/ds(t+1):
//
//   d h2 = W3' (d delta, d band),  d h1 = W2' act'(d h2),  carry(t-1) = carry(t) + W1' act'(d h1) + grad_state(t-1)
//
//   grad_state, grad_spread [steps][S][16]: gradient of the loss with respect to predicted state and spread
//   d_out [steps][S][32] = d delta | d band; d_h1, d_h2 [steps][S][HIDDEN]: with respect to the pre-activations
//   y1, y2 [steps][S][HIDDEN]: arguments of the activation's slope: pre_activation1/2 or h1/h2
//   w2 [HIDDEN][HIDDEN], w3 [2 STATE][HIDDEN] as [output][input]; w1 [HIDDEN][16], zero-padded
//
// The weight gradients are matrix products over all rows of these arrays (dense.cl).
//
// -D HIDDEN, STATE, ACTIVATION: see dynamics.clh

// Writes act'(d, y), [4][HIDDEN] from column n, to the sequences' rows of d_h.
static void store_gradient(wide_tile t, row_pointers y, int n, __global real* d_h, int s,
                           int sequences) {
  y = shifted(y, n);
#define STORE(r)                                                       \
  {                                                                    \
    __global real* to = d_h + SEQUENCE(r) * HIDDEN + n;                \
    store16(ACTIVATE_BACKWARD(t.a##r##0, vload16(0, y.x##r)), 0, to); \
    store16(ACTIVATE_BACKWARD(t.a##r##1, vload16(1, y.x##r)), 1, to); \
    store16(ACTIVATE_BACKWARD(t.a##r##2, vload16(2, y.x##r)), 2, to); \
    store16(ACTIVATE_BACKWARD(t.a##r##3, vload16(3, y.x##r)), 3, to); \
  }
  ROWS(STORE)
#undef STORE
}

static void hidden_layer_backward(row_pointers d_h2, __global const real* w2, row_pointers y1,
                                  __global real* d_h1, int s, int sequences) {
  for (int n = 0; n < HIDDEN; n += 64) {
    const wide_tile t = multiply_wide(zero_wide(), d_h2, 1, w2 + n, HIDDEN, HIDDEN);
    store_gradient(t, y1, n, d_h1, s, sequences);
  }
}

__kernel void rollout_backward(__global const real* grad_state, __global const real* grad_spread,
                               __global const real* spread, __global const real* y1,
                               __global const real* y2, __global const real* parameters, int w2_at,
                               int w3_at, __global const real* w1, __global real* d_out,
                               __global real* d_h1, __global real* d_h2, int sequences, int steps) {
  const int s = get_global_id(0) * 4;
  narrow_tile carry = fill_narrow((real16)(0));
  for (int t = steps - 1; t >= 0; --t) {
    const size_t row = (size_t)t * sequences;
    carry = output_gradient(carry, grad_state, grad_spread, spread, d_out, row, s, sequences);
    const size_t hidden = row * HIDDEN;
    const row_pointers d_out_now = rows_of(d_out + row * 32, 32, s, sequences);
    for (int n = 0; n < HIDDEN; n += 64)
      store_gradient(output_layer_backward(zero_wide(), d_out_now, parameters + w3_at, n),
                     rows_of(y2 + hidden, HIDDEN, s, sequences), n, d_h2 + hidden, s, sequences);
    hidden_layer_backward(rows_of(d_h2 + hidden, HIDDEN, s, sequences), parameters + w2_at,
                          rows_of(y1 + hidden, HIDDEN, s, sequences), d_h1 + hidden, s, sequences);
    carry = multiply_narrow(carry, rows_of(d_h1 + hidden, HIDDEN, s, sequences), 1, w1, 16, HIDDEN);
  }
}
