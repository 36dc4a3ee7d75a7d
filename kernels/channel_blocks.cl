// Conversions between images in blocks of 16 channels with a halo (conv2d.clh) and the rows of a dense layer, which
// keep the block order but have no halo: [image][channel / 16][row][column][channel % 16].
//
//   block_gradient:  image = row_gradient where row > 0, else 0 (the mask of the ReLU)
//   to_blocks:       parameter row [channel][row][column] to block order
//   from_blocks:     block order to parameter row
//
// ITEMS work-items share a block; each takes every ITEMS-th pixel.
//
// -D ROWS, COLS: no defaults
// -D ITEMS=1: as many as pixels on GPUs
// -D HALO=1: of the images
#ifndef HALO
#define HALO 1
#endif
#ifndef ITEMS
#define ITEMS 1
#endif
#define AREA (ROWS * COLS)
#define PITCH (16 * (COLS + 2 * HALO))
#define BLOCK (PITCH * (ROWS + 2 * HALO))
#define CORNER (HALO * (PITCH + 16))
#define EACH_PIXEL(pixel) for (int pixel = get_global_id(0) % ITEMS; pixel < AREA; pixel += ITEMS)

// `first`: index of the first image's first block in `row` and `row_gradient`.
__kernel void block_gradient(__global const real* restrict row, __global const real* restrict row_gradient,
                             __global real* restrict image, int first) {
  const size_t block = get_global_id(0) / ITEMS;
  image += block * BLOCK + CORNER;
  row += (first + block) * AREA * 16;
  row_gradient += (first + block) * AREA * 16;
  EACH_PIXEL(pixel) {
    const real16 gradient = vload16(pixel, row_gradient);
    const real16 masked = select((real16)(0), gradient, vload16(pixel, row) > (real16)(0));
    store16(masked, pixel % COLS, image + pixel / COLS * PITCH);
  }
}

__kernel void to_blocks(__global const real* restrict plain, int plain_at, __global real* restrict blocks) {
  const size_t at = get_global_id(0) / ITEMS * AREA * 16;
  EACH_PIXEL(pixel)
    for (int lane = 0; lane < 16; ++lane)
      blocks[at + pixel * 16 + lane] = plain[plain_at + at + lane * AREA + pixel];
}

__kernel void from_blocks(__global const real* restrict blocks, __global real* restrict plain, int plain_at) {
  const size_t at = get_global_id(0) / ITEMS * AREA * 16;
  for (int lane = 0; lane < 16; ++lane)
    EACH_PIXEL(pixel)
      plain[plain_at + at + lane * AREA + pixel] = blocks[at + pixel * 16 + lane];
}
