// Gradient of conv2d.clh towards its input on GPUs; the input must stand in blocks.
//
//   grad_in[c][y][x] = [in[c][y][x] > 0] sum_{k, taps} weight[k][c][i][j] grad_out[k][..][..]
//
// A gather: the taps that the input pixel (STRIDE a + row, STRIDE b + column) gets follow from its class (row, column)
// alone. So each class is a matrix product: its rows are the input pixels of that class in all images, its
// columns input channels, its terms [tap of the class][output channel]. A work-group computes a tile of one class;
// TILE_COLUMNS divides IN_CHANNELS.
//
//   packed  [tap][output channel][input channel]
#define LEFT_ALONG_DEPTH 1

// One work-item a weight.
__kernel void conv2d_lanes_pack_turned(__global const real* restrict parameters, int weight_at,
                                       __global real* restrict packed) {
  const int in = get_global_id(0), out = get_global_id(1), tap = get_global_id(2);
  packed[(tap * OUT_CHANNELS + out) * IN_CHANNELS + in] = parameters[weight_at + out * TERMS + in * TAPS + tap];
}

// One axis of a class: how many pixels there are, and which taps they get: tap n is first_tap + n STRIDE and reads the
// output pixel first_out - n further on than the pixel's own place among its class.
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

// A pixel of a class, counted through all images.
typedef struct {
  int image, row, column;
} class_pixel;

static class_pixel pixel_of(int number, class_axis rows, class_axis columns) {
  const int area = rows.pixels * columns.pixels, inside = number % area;
  const class_pixel p = {number / area, inside / columns.pixels, inside % columns.pixels};
  return p;
}

// Where the pixel's first tap reads, without its channel.
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

__kernel IN_GROUPS void conv2d_lanes_data(
    __global const real* restrict grad_out, __global const real* restrict packed, __global const real*
    restrict in, __global real* restrict grad_in, int images) {
  const int row = get_group_id(2) / STRIDE, column = get_group_id(2) % STRIDE;
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
  grad_out[outs[q] + out_channel_place((k) % OUT_CHANNELS) - TAP_ROW(k) * OUT_PITCH - TAP_COLUMN(k) * OUT_STEP]
#define RIGHT(k, c) packed[(TAP(k) * OUT_CHANNELS + (k) % OUT_CHANNELS) * IN_CHANNELS + channel + (c)]
  lane_tile tile = fill_lanes((real4)(0));
  INNER_PRODUCT(tile, terms)
  const size_t lanes_at = (channel + lane_column()) / 16 * IN_BLOCK + lane_column() % 16;
#define STORE(r, sums)                                                                               \
  if (first + (r) < pixels) {                                                                        \
    const size_t at = lanes_at + in_of_class(pixel_of(first + (r), rows, columns), row, column);     \
    store_masked(sums, in + at, grad_in + at);                                                       \
  }
  EACH_LANE_ROW(STORE)
}
