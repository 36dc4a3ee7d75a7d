// total[0] = sum of n values, in ascending order. One work-item.
//
// -D EXACT: the sum is compensated
__kernel void sum(__global const real* values, int n, __global real* total) {
  real result = 0, compensation = 0;
  for (int i = 0; i < n; ++i) ADD_TO(real, result, compensation, values[i])
  total[0] = result;
}
