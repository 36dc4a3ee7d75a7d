// A depth image of solids as a stereo sensor measures it.
//
// Three launches, each one work-item a tile of LANES x TILE_ROWS pixels:
//   depth_noise    white normal fields: shift along x and y, disparity, holes
//   render_depth   depth along rays shifted by correlated noise (Handa et al., ICRA 2014)
//   measure_depth  disparity = f b / z + correlated noise, in steps; holes; counts
// Images between the launches have HALO pixels around them: row stride width + 2 HALO.
//
// A noise field is the mean of 3x3 white numbers times 3: unit variance, correlated over 3 pixels,
// as neighbouring matching windows of a stereo sensor overlap.
//
// -D TILE_ROWS=8, -D MAX_SOLIDS=96
// -D HALO=128: a multiple of LANES, more than the widest occlusion shadow in pixels
#ifndef TILE_ROWS
#define TILE_ROWS 8
#endif
#ifndef MAX_SOLIDS
#define MAX_SOLIDS 96
#endif
#ifndef HALO
#define HALO 128
#endif

ALWAYS_INLINE int padded(int row, int column, int width) {
  return (row + HALO) * (width + 2 * HALO) + column + HALO;
}
ALWAYS_INLINE int padded_size(int width, int height) {
  return (width + 2 * HALO) * (height + 2 * HALO);
}

// Launched over the image and one tile more on each side.
__kernel void depth_noise(uint2 key, int width, int height, __global float* fields) {
  const int column = ((int)get_global_id(0) - 1) * LANES;
  const int first_row = ((int)get_global_id(1) - 1) * TILE_ROWS;
  const int size = padded_size(width, height);
  for (int row = max(first_row, -1); row < min(first_row + TILE_ROWS, height + 1); ++row) {
    const int pixel = padded(row, column, width);
    const philox_block random = philox(pixel, 1, key);
    vstore16(nearly_normal(random.w0), 0, fields + pixel);
    vstore16(nearly_normal(random.w1), 0, fields + size + pixel);
    vstore16(nearly_normal(random.w2), 0, fields + 2 * size + pixel);
    vstore16(nearly_normal(random.w3), 0, fields + 3 * size + pixel);
  }
}

ALWAYS_INLINE lanes row_sum(__global const float* field) {
  return load_lanes(field - 1) + load_lanes(field) + load_lanes(field + 1);
}

ALWAYS_INLINE lanes correlated(__global const float* field, int stride) {
  return (row_sum(field - stride) + row_sum(field) + row_sum(field + stride)) * (1.0f / 3.0f);
}

// rays_x, rays_y, tiles, solids: as in render_color.cl.
// shift: sigma of the shift of a ray along x', y'.
// disparity [height, width] with halo: focal_baseline / z in pixels of the image, about 0 where
// nothing is hit.
__kernel void render_depth(__global const float* rays_x, __global const float* rays_y,
                           __global const float4* tiles, __global const float* solids, int count,
                           float2 shift, float focal_baseline, int width, int height,
                           __global const float* fields, __global float* disparity) {
  const int column = get_global_id(0) * LANES, first_row = get_global_id(1) * TILE_ROWS;
  const int stride = width + 2 * HALO, size = padded_size(width, height);
  int visible[MAX_SOLIDS];
  const int seen = visible_solids(
      solids, count, 1, tiles[get_global_id(1) * get_global_size(0) + get_global_id(0)], visible);
  for (int row = first_row; row < min(first_row + TILE_ROWS, height); ++row) {
    const int pixel = padded(row, column, width);
    const lanes x =
        load_lanes(rays_x + row * width + column) + shift.x * correlated(fields + pixel, stride);
    const lanes y = load_lanes(rays_y + row * width + column) +
                    shift.y * correlated(fields + size + pixel, stride);
    lanes nearest = FAR;
    for (int i = 0; i < seen; ++i) {
      __global const float* s = solids + visible[i] * SOLID_FLOATS;
      if (!is_hidden(s, nearest)) nearest = min(nearest, hit_solid(s, direction_in_shape(s, x, y)));
    }
    vstore16(focal_baseline / nearest, 0, disparity + pixel);
  }
}

// No step of a pixel or more from one row above to one below, nor in the widest shadow to the
// right: most of an image, which then needs no search for holes.
ALWAYS_INLINE bool is_smooth(__global const float* disparity, int stride, int widest_shadow) {
  lanes low = FAR, high = 0.0f;
  for (int row = -stride; row <= stride; row += stride)
    for (int k = -1; k < widest_shadow + LANES - 1; k += LANES) {
      const lanes d = load_lanes(disparity + row + k);
      low = min(low, d), high = max(high, d);
    }
  return largest(high) + largest(-low) < 1.0f;
}

// Seen by the first imager only: a point to the right lands on the same pixel of the second one.
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

// sensor: sigma and step of disparity in pixels of the sensor, nearest and farthest depth in
// metres. sensor_px: pixels of the sensor to one of the image. error: offset and 1 / (scale unit)
// of counts = (z - offset) / (scale unit). widest_shadow: of occlusions in pixels of the image,
// less than HALO; 0: no holes at all.
__kernel void measure_depth(__global const float* disparity, __global const float* fields,
                            float4 sensor, float focal_baseline, float sensor_px, float2 error,
                            int widest_shadow, int width, int height, __global ushort* counts) {
  const int column = get_global_id(0) * LANES, first_row = get_global_id(1) * TILE_ROWS;
  const int stride = width + 2 * HALO, size = padded_size(width, height);
  for (int row = first_row; row < min(first_row + TILE_ROWS, height); ++row) {
    const int pixel = padded(row, column, width);
    const lanes own = load_lanes(disparity + pixel);
    lanes measured = own * sensor_px + sensor.x * correlated(fields + 2 * size + pixel, stride);
    if (sensor.y > 0.0f) measured = rint(measured / sensor.y) * sensor.y;
    const lanes metres = focal_baseline * sensor_px / measured;
    lane_mask valid = metres > sensor.z && metres < sensor.w;
    if (widest_shadow > 0 && !is_smooth(disparity + pixel, stride, widest_shadow)) {
      const lane_mask ragged = correlated(fields + 3 * size + pixel, stride) > 0.0f;
      valid &= !occluded(disparity + pixel, own, widest_shadow);
      valid &= !(ragged && at_edge(disparity + pixel, stride, own));
    }
    const lanes value = rint((metres - error.x) * error.y);
    const lanes stored = (valid && value > 0.0f && value < 65535.0f) ? value : (lanes)0.0f;
    vstore16(convert_ushort16(stored), 0, counts + row * width + column);
  }
}
