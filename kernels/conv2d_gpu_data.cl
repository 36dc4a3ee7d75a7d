// Gradient of the convolution with respect to its input on GPUs; the input is in blocks (conv2d.clh).
//
//   grad_in[c][y][x] = [in[c][y][x] > 0] sum_{k, taps} weight[k][c][i][j] grad_out[k][..][..]
//
// The sum is a gather. The taps that reach input pixel (STRIDE a + row, STRIDE b + column) depend only on its class
// (row, column). Each class is a matrix product: rows are the input pixels of that class in all images, columns are
// input channels, terms are [tap of the class][output channel]. One work-group per tile of one class (gpu_tile.clh);
// TILE_COLUMNS divides IN_CHANNELS. Inputs with fewer rows or columns than STRIDE have no pixels of the last classes,
// which are not launched.
//
//   packed [tap][output channel][input channel]
//
// -D: see conv2d.clh, gpu_tile.clh
#define LEFT_ALONG_DEPTH 1
#define COLUMN_CLASSES min(STRIDE, IN_COLS)

// One work-item per weight.
__kernel void conv2d_gpu_pack_transposed(__global const real* restrict parameters, int weight_at,
                                       __global real* restrict packed) {
  const int in = get_global_id(0), out = get_global_id(1), tap = get_global_id(2);
  packed[(tap * OUT_CHANNELS + out) * IN_CHANNELS + in] = parameters[weight_at + out * TERMS + in * TAPS + tap];
}

// One axis of a class. Tap n of the class is first_tap + n STRIDE; for the class's pixel a it reads output pixel
// a + first_out - n.
typedef struct {
  int pixels, first_tap, taps, first_out;
} class_axis;

static class_axis axis_of(int remainder, int size) {
  class_axis axis;
  axis.pixels = (size - remainder + STRIDE - 1) / STRIDE;
  axis.first_tap = (remainder + HALO) % STRIDE;
  axis.taps = (KERNEL - axis.first_tap + STRIDE - 1) / STRIDE;
  axis.first_out = (remainder + HALO) / STRIDE;
  return axis;
}

// Position of a pixel within its class.
typedef struct {
  int image, row, column;
} class_pixel;

static class_pixel pixel_of(int number, class_axis rows, class_axis columns) {
  const int area = rows.pixels * columns.pixels, inside = number % area;
  const class_pixel p = {number / area, inside / columns.pixels, inside % columns.pixels};
  return p;
}

// Offset of the output pixel that the class pixel's first tap reads, in channel 0.
static size_t out_of_class(class_pixel p, class_axis rows, class_axis columns) {
  return (size_t)p.image * OUT_IMAGE + OUT_CORNER + (p.row + rows.first_out) * OUT_PITCH +
         (p.column + columns.first_out) * OUT_STEP;
}

static size_t in_of_class(class_pixel p, int row, int column) {
  return (size_t)p.image * IN_IMAGE + IN_CORNER + (STRIDE * p.row + row) * IN_PITCH +
         (STRIDE * p.column + column) * IN_STEP;
}

static void store_masked(real4 sums, __global const real* in, __global real* grad_in) {
  vstore4(select((real4)(0), sums, vload4(0, in) > (real4)(0)), 0, grad_in);
}

__kernel WORK_GROUP_ATTRIBUTE void conv2d_gpu_data(
    __global const real* restrict grad_out, __global const real* restrict packed, __global const real*
    restrict in, __global real* restrict grad_in, int images) {
  const int row = get_group_id(2) / COLUMN_CLASSES, column = get_group_id(2) % COLUMN_CLASSES;
  const class_axis rows = axis_of(row, IN_ROWS), columns = axis_of(column, IN_COLS);
  const int pixels = images * rows.pixels * columns.pixels, terms = rows.taps * columns.taps * OUT_CHANNELS;
  const int first = get_group_id(0) * TILE_ROWS, channel = get_group_id(1) * TILE_COLUMNS;
  size_t outs[LEFT_VALUES];
  for (int q = 0; q < LEFT_VALUES; ++q)
    outs[q] = out_of_class(pixel_of(min(first + LEFT_ROW(q), pixels - 1), rows, columns), rows, columns);
#define TAP_ROW(k) ((k) / OUT_CHANNELS / columns.taps)
#define TAP_COLUMN(k) ((k) / OUT_CHANNELS % columns.taps)
#define TAP(k) ((rows.first_tap + TAP_ROW(k) * STRIDE) * KERNEL + columns.first_tap + TAP_COLUMN(k) * STRIDE)
#define LEFT(q, r, k) \
  grad_out[outs[q] + out_channel_offset((k) % OUT_CHANNELS) - TAP_ROW(k) * OUT_PITCH - TAP_COLUMN(k) * OUT_STEP]
#define RIGHT(k, c) packed[(TAP(k) * OUT_CHANNELS + (k) % OUT_CHANNELS) * IN_CHANNELS + channel + (c)]
  item_tile tile = fill_tile((real4)(0));
  INNER_PRODUCT(tile, terms)
  const size_t channels_at = (channel + item_column()) / 16 * IN_BLOCK + item_column() % 16;
#define STORE(r, sums)                                                                               \
  if (first + (r) < pixels) {                                                                        \
    const size_t at = channels_at + in_of_class(pixel_of(first + (r), rows, columns), row, column);     \
    store_masked(sums, in + at, grad_in + at);                                                       \
  }
  EACH_ITEM_ROW(STORE)
}
