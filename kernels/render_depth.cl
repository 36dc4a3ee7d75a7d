// Disparities of solids as seen by the first imager of a stereo sensor; measure_depth.cl turns them into depth. Two
// launches, each with one work-item per tile of LANES x TILE_ROWS pixels:
//   depth_noise    white normal fields: shift along x and y, disparity, holes
//   render_depth   depth along rays shifted by correlated noise (Handa et al., ICRA 2014)
// Needs pixel_vectors.clh, solids.clh, visible_solids.clh, image_noise.clh, depth_fields.clh.
//
// -D TILE_ROWS, HALO: see depth_fields.clh; -D MAX_SOLIDS: see visible_solids.clh

// Launched over the image plus one tile on every side.
__kernel void depth_noise(uint2 key, int width, int height, __global float* fields) {
  const int column = ((int)get_global_id(0) - 1) * LANES;
  const int first_row = ((int)get_global_id(1) - 1) * TILE_ROWS;
  const int size = padded_size(width, height);
  for (int row = max(first_row, -1); row < min(first_row + TILE_ROWS, height + 1); ++row) {
    const int pixel = padded(row, column, width);
    const philox_block random = philox(pixel, 1, key);
    store_lanes(fields + pixel, nearly_normal(random.w0));
    store_lanes(fields + size + pixel, nearly_normal(random.w1));
    store_lanes(fields + 2 * size + pixel, nearly_normal(random.w2));
    store_lanes(fields + 3 * size + pixel, nearly_normal(random.w3));
  }
}

// rays_x, rays_y, tiles, solids: as in render_color.cl.
// shift: standard deviation of the shift of a ray along x', y'.
// disparity [height, width] with halo: focal_baseline / z in image pixels, about 0 if nothing is hit.
__kernel void render_depth(__global const float* rays_x, __global const float* rays_y,
                           __global const float4* tiles, __global const float* solids, int count,
                           float2 shift, float focal_baseline, int width, int height,
                           __global const float* fields, __global float* disparity) {
  const int column = get_global_id(0) * LANES, first_row = get_global_id(1) * TILE_ROWS;
  const int stride = width + 2 * HALO, size = padded_size(width, height);
  int visible[MAX_SOLIDS];
  __global const float *along_x = fields + padded(first_row, column, width),
                       *along_y = along_x + size;
  row_sums sums_x = sums_before(along_x, stride), sums_y = sums_before(along_y, stride);
  const int seen = visible_solids(solids, count, 1,
                                  tiles[get_global_id(1) * get_global_size(0) + get_global_id(0)],
                                  0, count, visible);
  for (int row = first_row; row < min(first_row + TILE_ROWS, height);
       ++row, along_x += stride, along_y += stride) {
    const lanes x =
        load_lanes(rays_x + row * width + column) + shift.x * correlated(along_x, stride, &sums_x);
    const lanes y =
        load_lanes(rays_y + row * width + column) + shift.y * correlated(along_y, stride, &sums_y);
    lanes nearest = FAR;
    for (int i = 0; i < seen; ++i) {
      __global const float* s = solids + visible[i] * SOLID_FLOATS;
      if (!is_hidden(s, nearest)) nearest = min(nearest, hit_solid(s, direction_in_shape(s, x, y)));
    }
    store_lanes(disparity + padded(row, column, width), focal_baseline / nearest);
  }
}
