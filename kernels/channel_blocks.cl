// Between images in blocks of 16 channels (conv2d.clh) and plain arrays [image][channel][row][column].
//
//   unblock:          plain = blocked
//   block_gradient:   blocked = [plain > 0] plain_gradient, the ReLU's mask applied on the way
//
// -D ROWS, COLS: without defaults. A work-item moves one block of an image; plain arrays are taken from block
// `first` on.
#define PITCH (16 * (COLS + 2))
#define BLOCK (PITCH * (ROWS + 2))
#define PLAIN_BLOCK (16 * ROWS * COLS)

__kernel void unblock(__global const real* restrict blocked, __global real* restrict plain, int first) {
  const size_t block = get_global_id(0);
  __global const real* from = blocked + block * BLOCK + PITCH + 16;
  __global real* to = plain + (first + block) * PLAIN_BLOCK;
  for (int y = 0; y < ROWS; ++y)
    for (int x = 0; x < COLS; ++x)
      for (int lane = 0; lane < 16; ++lane)
        to[(lane * ROWS + y) * COLS + x] = from[y * PITCH + x * 16 + lane];
}

__kernel void block_gradient(__global const real* restrict plain, __global const real* restrict gradient,
                             __global real* restrict blocked, int first) {
  const size_t block = get_global_id(0);
  __global real* to = blocked + block * BLOCK + PITCH + 16;
  for (int y = 0; y < ROWS; ++y)
    for (int x = 0; x < COLS; ++x)
      for (int lane = 0; lane < 16; ++lane) {
        const size_t at = (first + block) * PLAIN_BLOCK + (lane * ROWS + y) * COLS + x;
        to[y * PITCH + x * 16 + lane] = plain[at] > 0 ? gradient[at] : 0;
      }
}
