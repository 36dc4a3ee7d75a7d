// Input of the tactile encoder: windows of WINDOW (M) frames of a stream, in the difference basis.
//
//   out[w][c]     = keep[w] 5 (frame[t - M + 2 + c] - frame[t - M + 1 + c]),  c = 0 .. M - 2
//   out[w][M - 1] = keep[w] frame[t],                                         t = last_frame[w]
//
// keep[w] is 0 for dropped taxels and 1 / (1 - rate) for the others. A taxel is dropped if
// hash(key, w ROWS COLS + taxel) < threshold.
//
// frames [frame][row][column]; out in planes (conv2d.clh), from window `first` on. ROW_ITEMS work-items
// share a row of one window.
//
// -D WINDOW, ROWS, COLS: no defaults
// -D HALO=1: of `out`
// -D LANES: vector width, 1, 4, 8 or 16, at most COLS; no default
// -D ROW_ITEMS=1: COLS, with LANES=1, on GPUs
#ifndef ROW_ITEMS
#define ROW_ITEMS 1
#endif
#ifndef HALO
#define HALO 1
#endif
#define OUT_PITCH (COLS + 2 * HALO)
#define OUT_PLANE (OUT_PITCH * (ROWS + 2 * HALO))

#if LANES == 1
#define realv real
#define uintv uint
#define load_lanes(from) (*(from))
#define store_lanes_at(value, to) (*(to) = (value))
#define lane_numbers() 0
#else
#define realv JOIN(REAL, LANES)
#define uintv JOIN(uint, LANES)
#define load_lanes(from) JOIN(vload, LANES)(0, from)
#define store_lanes_at(value, to) JOIN(vstore, LANES)(value, 0, to)
#define lane_numbers() JOIN(JOIN(first_, LANES), _numbers)
#define first_4_numbers (uint4)(0, 1, 2, 3)
#define first_8_numbers (uint8)(0, 1, 2, 3, 4, 5, 6, 7)
#define first_16_numbers (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#endif

// The 32-bit mixer of Wellons ("lowbias32"): a bijection.
static uintv mixed(uintv x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

static realv keep_of(uint key, uint threshold, real scale, uint first) {
  const uintv hash = mixed(mixed(first + lane_numbers()) ^ key);
  return select((realv)(scale), (realv)(0), hash < threshold);
}

__kernel void tactile_window(__global const real* restrict frames, __global const int* restrict last_frame,
                             __global real* restrict out, uint key, uint threshold, real scale,
                             int first) {
  const int row = get_global_id(0) / ROW_ITEMS, window = first + get_global_id(1);
  __global real* to = out + get_global_id(1) * WINDOW * OUT_PLANE + (row + HALO) * OUT_PITCH + HALO;
  __global const real* oldest = frames + ((size_t)last_frame[window] - WINDOW + 1) * ROWS * COLS + row * COLS;
  for (int step = get_global_id(0) % ROW_ITEMS * LANES; step < COLS; step += ROW_ITEMS * LANES) {
    const int column = min(step, COLS - LANES);  // the last vector may overlap the previous one
    const realv keep = keep_of(key, threshold, scale, (uint)((window * ROWS + row) * COLS + column));
    realv frame = load_lanes(oldest + column);
    for (int c = 0; c < WINDOW - 1; ++c) {
      const realv next = load_lanes(oldest + (c + 1) * ROWS * COLS + column);
      store_lanes_at(keep * ((real)5 * (next - frame)), to + c * OUT_PLANE + column);
      frame = next;
    }
    store_lanes_at(keep * frame, to + (WINDOW - 1) * OUT_PLANE + column);
  }
}
