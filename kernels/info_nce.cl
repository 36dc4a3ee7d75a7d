// InfoNCE over N embeddings e_i, each of a known object (equation 5, negated), and its gradient. Every ordered pair of
// an anchor i and another embedding p of its object is a positive pair; the embeddings j of all other objects are its
// negatives:
//
//   loss[i] = weight[i] sum_p -log(exp(s_ip) / (exp(s_ip) + sum_j exp(s_ij)))
//
//   s_ij = e_i . e_j,  or with NORMALISED  s_ij = e_i . e_j / (temperature n_i n_j),  n_i = sqrt(|e_i|^2 + 1e-24)
//
// The loss may be as small as exp(-80) while logits are 1e4. Logits are therefore double-word numbers (unevaluated sums
// of two numbers), exponents are differences of logits, and the largest term of a sum of exponentials is factored out
// of its logarithm.
//
// -D COLUMNS: size of an embedding, a multiple of 16; no default
// -D NORMALISED=0: or 1
#pragma OPENCL FP_CONTRACT OFF
#ifndef NORMALISED
#define NORMALISED 0
#endif

typedef JOIN(REAL, 2) pair;  // x + y, |y| at most half a unit in the last place of x

static pair exact_sum(real a, real b) {
  const real sum = a + b, part = sum - a;
  return (pair)(sum, (a - (sum - part)) + (b - part));
}

static pair product(pair a, pair b) {
  const real high = a.x * b.x;
  return exact_sum(high, fma(a.x, b.x, -high) + (a.x * b.y + a.y * b.x));
}

static pair difference(pair a, pair b) {
  const pair high = exact_sum(a.x, -b.x);
  return exact_sum(high.x, high.y + (a.y - b.y));
}

static real exponential(pair a) { return exp(a.x) * (1 + a.y); }

static pair dot_product(__global const real* a, __global const real* b) {
  real16 sum = 0, rest = 0;
  for (int v = 0; v < COLUMNS / 16; ++v) {
    const real16 x = vload16(v, a), y = vload16(v, b), term = x * y;
    const real16 next = sum + term, part = next - sum;
    rest += (sum - (next - part)) + (term - part) + fma(x, y, -term);
    sum = next;
  }
  real sums[16], rests[16];
  store16_private(sum, 0, sums), store16_private(rest, 0, rests);
  pair total = 0;
  for (int lane = 0; lane < 16; ++lane) {
    const pair next = exact_sum(total.x, sums[lane]);
    total = (pair)(next.x, total.y + (next.y + rests[lane]));
  }
  return exact_sum(total.x, total.y);
}

// scale[i] = 1 / (n_i sqrt(temperature)). One work-item per embedding.
__kernel void info_nce_scales(__global const real* embedding, real temperature, __global pair* scale) {
  const size_t i = get_global_id(0);
  const pair squares = dot_product(embedding + i * COLUMNS, embedding + i * COLUMNS);
  const pair value = product(exact_sum(squares.x, squares.y + (real)1e-24), (pair)(temperature, 0));
  const real root = rsqrt(value.x);
  const pair one = product(value, product((pair)(root, 0), (pair)(root, 0)));
  scale[i] = exact_sum(root, (real)0.5 * root * ((1 - one.x) - one.y));
}

// logit[i][j] = s_ij. One work-item per pair. `scale` is read only if NORMALISED.
__kernel void info_nce_logits(__global const real* embedding, __global const pair* scale,
                              __global pair* logit) {
  const size_t j = get_global_id(0), i = get_global_id(1), count = get_global_size(0);
  pair value = dot_product(embedding + i * COLUMNS, embedding + j * COLUMNS);
  if (NORMALISED) value = product(value, product(scale[i], scale[j]));
  logit[i * count + j] = value;
}

// loss[loss_at + i] and slope[i][j] = d loss[i] / d s_ij. One work-item per anchor.
__kernel void info_nce_rows(__global const pair* logit, __global const int* object,
                            __global const real* weight, __global real* loss, int loss_at,
                            __global real* slope) {
  const int i = get_global_id(0), count = get_global_size(0);
  logit += (size_t)i * count, slope += (size_t)i * count;
  const real w = weight[i];
  int top = -1;  // the largest negative
  for (int j = 0; j < count; ++j)
    if (object[j] != object[i] && (top < 0 || logit[j].x > logit[top].x)) top = j;

  real others = 0, total = 0, pull = 0;  // others, total: relative to exp(s_i,top); pull: of all positives
  for (int j = 0; j < count; ++j) {
    slope[j] = top >= 0 && object[j] != object[i] ? exponential(difference(logit[j], logit[top])) : 0;
    if (j != top) others += slope[j];
  }
  for (int p = 0; p < count && top >= 0 && w != 0; ++p) {
    if (p == i || object[p] != object[i]) continue;
    const pair lead = difference(logit[top], logit[p]);
    const bool ahead = lead.x > 0;  // of the positive
    const real term = ahead ? others + exponential(-lead) : (1 + others) * exponential(lead);
    const real share = (ahead ? 1 + others : term) / (1 + term);  // of all negatives
    total += log1p(term) + (ahead ? lead.x + lead.y : 0);
    slope[p] = -w * share;
    pull += w * share;
  }
  for (int j = 0; j < count; ++j)
    if (object[j] != object[i]) slope[j] *= pull / (1 + others);
  loss[loss_at + i] = w * total;
}

// gradient[i] += sum_j (slope[i][j] + slope[j][i]) d s_ij / d e_i. One work-item per 16 values of an embedding.
__kernel void info_nce_gradient(__global const real* embedding, __global const pair* scale,
                                real temperature, __global const pair* logit,
                                __global const real* slope, __global real* gradient) {
  const size_t v = get_global_id(0), i = get_global_id(1), count = get_global_size(1);
  gradient += i * COLUMNS;
  real16 sum = vload16(v, gradient);
  real along = 0;  // gradient along e_i, through n_i
  for (size_t j = 0; j < count; ++j) {
    const real both = slope[i * count + j] + slope[j * count + i];
    const real factor = NORMALISED ? both * scale[i].x * scale[j].x : both;
    along += both * logit[i * count + j].x;
    sum = fma((real16)(factor), vload16(v, embedding + j * COLUMNS), sum);
  }
  if (NORMALISED) {
    const real16 factor = -along * temperature * scale[i].x * scale[i].x;
    sum = fma(factor, vload16(v, embedding + i * COLUMNS), sum);
  }
  store16(sum, v, gradient);
}
