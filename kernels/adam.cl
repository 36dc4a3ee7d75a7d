// Adam with decoupled weight decay (Loshchilov and Hutter 2019) and gradient norm clipping, over all parameters as one
// array of n values.
//
//   m = b1 m + (1 - b1) g,  v = b2 v + (1 - b2) g^2,  b1 = 0.9, b2 = 0.999, g clipped to norm `clip_norm`
//   p = p - rate (decay p + m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + 1e-8))
//
// One work-item processes CHUNK values, fewer at the end. Launches: squares or squares_gpu, norm, adam.
//
// -D EXACT: `compensation` [n] holds the rounding errors of p; undefined: `compensation` is not accessed
// -D CHUNK=1024: 1 on GPUs, so that neighbouring work-items access neighbouring values
#ifndef CHUNK
#define CHUNK 1024
#endif

// partial[chunk] = sum of the squared gradient values of the chunk.
__kernel void squares(__global const real* gradient, int n, __global real* partial) {
  const int chunk = get_global_id(0), end = min(n, (chunk + 1) * CHUNK);
  int i = chunk * CHUNK;
  real16 sums = 0, compensation = 0;
  for (; i + 16 <= end; i += 16) {
    const real16 g = vload16(0, gradient + i);
    ADD_TO(real16, sums, compensation, g * g)
  }
  const real8 a = sums.lo + sums.hi;
  const real4 b = a.lo + a.hi;
  real sum = b.x + b.y + b.z + b.w;
  for (; i < end; ++i) sum += gradient[i] * gradient[i];
  partial[chunk] = sum;
}

// GPU variant of squares. One work-group per chunk; each work-item adds every 256th value of it.
#define GROUP 256
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void squares_gpu(
    __global const real* gradient, int n, __global real* partial) {
  __local real sums[GROUP];
  const int item = get_local_id(0), begin = get_group_id(0) * CHUNK, end = min(n, begin + CHUNK);
  real sum = 0, compensation = 0;
  for (int i = begin + item; i < end; i += GROUP) ADD_TO(real, sum, compensation, gradient[i] * gradient[i])
  sums[item] = sum;
  for (int half_group = GROUP / 2; half_group > 0; half_group /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < half_group) sums[item] += sums[item + half_group];
  }
  if (item == 0) partial[get_group_id(0)] = sums[0];
}

// norm[0] = Euclidean norm of the gradient. One work-item.
__kernel void norm(__global const real* partial, int chunks, __global real* norm) {
  real sum = 0, compensation = 0;
  for (int i = 0; i < chunks; ++i) ADD_TO(real, sum, compensation, partial[i])
  norm[0] = sqrt(sum);
}

// Changes nothing if the norm or the loss is not finite. first_correction = 1 / (1 - b1^t), second_correction =
// 1 / (1 - b2^t).
__kernel void adam(__global real* parameters, __global const real* gradient, __global real* first,
                   __global real* second, __global const real* decay, int n,
                   __global const real* norm, __global const real* loss, real clip_norm, real rate,
                   real first_correction, real second_correction, __global real* compensation) {
  if (!isfinite(norm[0]) || !isfinite(loss[0])) return;
  const real clip = fmin((real)1, clip_norm / (norm[0] + (real)1e-6));
  const int chunk = get_global_id(0), end = min(n, (chunk + 1) * CHUNK);
  for (int i = chunk * CHUNK; i < end; ++i) {
    const real g = clip * gradient[i];
    const real m = first[i] = fma((real)0.1, g - first[i], first[i]);
    const real v = second[i] = fma((real)0.001, g * g - second[i], second[i]);
    const real step = m * first_correction / (sqrt(v * second_correction) + (real)1e-8);
    ADD_TO(real, parameters[i], compensation[i], -rate * fma(decay[i], parameters[i], step))
  }
}
