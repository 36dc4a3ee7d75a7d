// Peak floating-point throughput: 12 independent chains of fused multiply-adds on vectors of 16, no memory traffic.
// Reference for the shares of the peak that the engine's verification reports.
//
// 2 * 16 * 12 * iterations floating-point operations per work-item. out: 16 values per work-item, so that nothing is
// optimised away.
__kernel void fma_peak(__global real* restrict out, real factor, int iterations) {
#define START(n) real16 sum##n = (real16)(n);
  REPEAT(12, START)
#undef START
  const real16 f = (real16)(factor);
  for (int iteration = 0; iteration < iterations; ++iteration) {
#define MULTIPLY(n) sum##n = fma(sum##n, f, f);
    REPEAT(12, MULTIPLY)
#undef MULTIPLY
  }
  real16 total = 0;
#define TOTAL(n) total += sum##n;
  REPEAT(12, TOTAL)
#undef TOTAL
  store16(total, get_global_id(0), out);
}
