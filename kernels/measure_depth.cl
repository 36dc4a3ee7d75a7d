// Depth measured by a stereo sensor from the disparities of render_depth.cl: focal length * baseline / z + correlated
// noise, quantised; holes; counts. One work-item per tile of LANES x TILE_ROWS pixels. Needs pixel_vectors.clh,
// solids.clh, depth_fields.clh.
//
// -D TILE_ROWS, HALO: see depth_fields.clh

typedef ushort16 unaligned_counts __attribute__((aligned(2)));

// Range of the disparities in a row, from one pixel to the left to the widest shadow to the right.
typedef struct {
  lanes low, high;
} lane_range;

ALWAYS_INLINE lane_range range_of(__global const float* disparity, int widest_shadow) {
  lane_range range = {FAR, 0.0f};
  for (int k = -1; k < widest_shadow + LANES - 1; k += LANES) {
    const lanes d = load_lanes(disparity + k);
    range.low = min(range.low, d), range.high = max(range.high, d);
  }
  return range;
}

// Whether only the first imager sees the point: a point to the right maps to the same pixel of the second imager.
ALWAYS_INLINE lane_mask occluded(__global const float* disparity, lanes own, int widest_shadow) {
  lane_mask hidden = 0;
  for (int k = 1; k <= widest_shadow; ++k) hidden |= load_lanes(disparity + k) - own > (float)k;
  return hidden;
}

ALWAYS_INLINE lane_mask at_edge(__global const float* disparity, int stride, lanes own) {
  lane_mask edge = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      edge |= fabs(load_lanes(disparity + dy * stride + dx) - own) > 1.0f;
  return edge;
}

// sensor: standard deviation and quantisation step of the disparity [sensor pixels], min and max depth [m]
// sensor_px: sensor pixels per image pixel
// error: offset and 1 / (scale unit) of counts = (z - offset) / (scale unit)
// widest_shadow: of occlusions [image pixels], less than HALO; 0: no holes
__kernel void measure_depth(__global const float* disparity, __global const float* fields,
                            float4 sensor, float focal_baseline, float sensor_px, float2 error,
                            int widest_shadow, int width, int height, __global ushort* counts) {
  const int column = get_global_id(0) * LANES, first_row = get_global_id(1) * TILE_ROWS;
  const int stride = width + 2 * HALO, size = padded_size(width, height);
  int pixel = padded(first_row, column, width);
  row_sums sums = sums_before(fields + 2 * size + pixel, stride);
  lane_range above = range_of(disparity + pixel - stride, widest_shadow),
             level = range_of(disparity + pixel, widest_shadow);
  for (int row = first_row; row < min(first_row + TILE_ROWS, height); ++row, pixel += stride) {
    const lanes own = load_lanes(disparity + pixel);
    lanes measured =
        own * sensor_px + sensor.x * correlated(fields + 2 * size + pixel, stride, &sums);
    if (sensor.y > 0.0f) measured = nearest_integer(measured / sensor.y) * sensor.y;
    const lanes metres = focal_baseline * sensor_px / measured;
    lane_mask valid = metres > sensor.z && metres < sensor.w;
    const lane_range below = range_of(disparity + pixel + stride, widest_shadow);
    const float highest = largest(max(max(above.high, level.high), below.high));
    const float lowest = -largest(-min(min(above.low, level.low), below.low));
    above = level, level = below;
    if (widest_shadow > 0 && highest - lowest >= 1.0f) {  // holes occur only at steps of a pixel or more
      __global const float* ragged = fields + 3 * size + pixel;
      row_sums ragged_sums = sums_before(ragged, stride);
      valid &= !occluded(disparity + pixel, own, min(widest_shadow, (int)(highest - lowest)));
      valid &= !(correlated(ragged, stride, &ragged_sums) > 0.0f &&
                 at_edge(disparity + pixel, stride, own));
    }
    const lanes value = nearest_integer((metres - error.x) * error.y);
    const lanes stored = (valid && value > 0.0f && value < 65535.0f) ? value : (lanes)0.0f;
    *(__global unaligned_counts*)(counts + row * width + column) = convert_ushort16(stored);
  }
}
