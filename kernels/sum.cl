// total[0] = the sum of n values, in their order. One work-item.
__kernel void sum(__global const real* values, int n, __global real* total) {
  real result = 0, lost = 0;
  for (int i = 0; i < n; ++i) ADD_TO(real, result, lost, values[i])
  total[0] = result;
}
