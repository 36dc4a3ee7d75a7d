// Roll-out of the dynamics MLP (equation 1). One work-item takes four sequences through all steps.
//
//   h1 = act(first + W1 s),  h2 = act(W2 h1 + b2),  (delta, band) = W3 h2 + b3
//   s' = s + delta,  spread = softplus(band) > 0, so that the two quantiles never cross
//
// `first` is the part of layer 1 that no state enters: bias and the embedding's product, hoisted out
// of the loop. Rows are ordered [step][sequence].
//   states [steps + 1][S][16], the first S rows given; first [steps][S] rows, first_ld apart (0: one
//   row for all); h1, h2 [steps][S][HIDDEN]; spread [steps][S][16]; HIDDEN a multiple of 64
//   sum1, sum2 as h1, h2, before the activation: where its slope needs them, else unused
//   w1 [STATE][HIDDEN], w2 [HIDDEN][HIDDEN] as [input][output]; w3 [HIDDEN][32] and b3 [32] as
//   delta | band, each padded with zeros from STATE to 16

static wide_tile activated(wide_tile t) {
#define ACTIVATE_ROW(r)                                                     \
  t.a##r##0 = ACTIVATE(t.a##r##0), t.a##r##1 = ACTIVATE(t.a##r##1); \
  t.a##r##2 = ACTIVATE(t.a##r##2), t.a##r##3 = ACTIVATE(t.a##r##3);
  ROWS(ACTIVATE_ROW)
#undef ACTIVATE_ROW
  return t;
}

static void store_hidden(wide_tile t, __global real* h, int s, int sequences) {
#define STORE(r)                                            \
  {                                                         \
    __global real* to = h + SEQUENCE(r) * HIDDEN;           \
    vstore16(t.a##r##0, 0, to), vstore16(t.a##r##1, 1, to); \
    vstore16(t.a##r##2, 2, to), vstore16(t.a##r##3, 3, to); \
  }
  ROWS(STORE)
#undef STORE
}

// Writes act(start + x w), [4][HIDDEN], to the sequences' rows of h, and the sums to those of `sum`.
static void hidden_layer(row_pointers x, int count, __global const real* w, row_pointers start,
                         __global real* h, __global real* sum, int s, int sequences) {
  for (int n = 0; n < HIDDEN; n += 64) {
    const wide_tile t = multiply_wide(load_wide(shifted(start, n)), x, 1, w + n, HIDDEN, count);
    if (SLOPE_FROM_SUM) store_hidden(t, sum + n, s, sequences);
    store_hidden(activated(t), h + n, s, sequences);
  }
}

// log1p(u) as Kahan computes it: runtimes for CPUs have vectors of logarithms, but not of log1p.
static real16 log_one_plus(real16 u) {
  const real16 sum = 1 + u;
  return select(log(sum) * (u / (sum - 1)), u, sum == (real16)(1));
}

static real16 softplus(real16 x) { return fmax(x, (real16)(0)) + log_one_plus(exp(-fabs(x))); }

static void output_layer(row_pointers h2, __global const real* w3, __global const real* b3,
                         row_pointers now, __global real* next, __global real* spread, int s,
                         int sequences) {
  narrow_tile delta = fill_narrow(vload16(0, b3)), band = fill_narrow(vload16(1, b3));
  delta = multiply_narrow(delta, h2, 1, w3, 32, HIDDEN);
  band = multiply_narrow(band, h2, 1, w3 + 16, 32, HIDDEN);
#define STORE(r)                                         \
  vstore16(vload16(0, now.x##r) + delta.a##r, SEQUENCE(r), next); \
  vstore16(softplus(band.a##r), SEQUENCE(r), spread);
  ROWS(STORE)
#undef STORE
}

__kernel void rollout(__global real* states, __global const real* first, int first_at, int first_ld,
                      __global const real* parameters, int b2_at, __global const real* w1,
                      __global const real* w2, __global const real* w3, __global const real* b3,
                      __global real* h1, __global real* h2, __global real* sum1, __global real* sum2,
                      __global real* spread, int sequences, int steps) {
  const int s = get_global_id(0) * 4;
  const row_pointers b2 = rows_of(parameters + b2_at, 0, 0, 1);
  first += first_at;
  for (int t = 0; t < steps; ++t) {
    const row_pointers now = rows_of(states, 16, s, sequences);
    states += sequences * 16;
    hidden_layer(now, STATE, w1, rows_of(first, first_ld, s, sequences), h1, sum1, s, sequences);
    hidden_layer(rows_of(h1, HIDDEN, s, sequences), HIDDEN, w2, b2, h2, sum2, s, sequences);
    output_layer(rows_of(h2, HIDDEN, s, sequences), w3, b3, now, states, spread, s, sequences);
    first += (size_t)sequences * first_ld;
    h1 += sequences * HIDDEN, h2 += sequences * HIDDEN, spread += sequences * 16;
    sum1 += sequences * HIDDEN, sum2 += sequences * HIDDEN;
  }
}
