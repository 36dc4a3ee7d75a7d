// average = average + rate (values - average), over n values.
__kernel void moving_average(__global const real* values, real rate, __global real* average) {
  const int i = get_global_id(0);
  average[i] = fma(rate, values[i] - average[i], average[i]);
}
