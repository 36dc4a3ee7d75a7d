// Packs weights [out][in][KERNEL][KERNEL] in the order in which the CPU convolutions read them (conv2d.clh):
//
//   packed [group of BLOCKS blocks][summed channel][tap][TAP_SIZE lanes]
//
// Lanes are output channels for the forward pass and input channels for the gradient with respect to the input.
//
// -D BLOCKS: blocks of 16 lanes in a tile, no default
// Other -D: see conv2d.clh
#define TAP_SIZE (16 * BLOCKS)
#define CHANNEL_SIZE (TAPS * TAP_SIZE)

// One work-item per (channel, group). The first tap of lane l and channel c is
// parameters[at + l * lane_stride + c * channel_stride].
__kernel void conv2d_pack(__global const real* restrict parameters, int at, int lane_stride,
                          int channel_stride, __global real* restrict packed) {
  const int channel = get_global_id(0), group = get_global_id(1);
  __global const real* from = parameters + at + channel * channel_stride + group * TAP_SIZE * lane_stride;
  __global real* to = packed + (group * (int)get_global_size(0) + channel) * CHANNEL_SIZE;
  for (int lane = 0; lane < TAP_SIZE; ++lane)
    for (int tap = 0; tap < TAPS; ++tap) to[tap * TAP_SIZE + lane] = from[lane * lane_stride + tap];
}
