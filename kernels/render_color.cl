// Renders a colour image of solids: surface light, motion blur, sensor noise.
//
// One work-item renders a tile of LANES x TILE_ROWS pixels, one row strip after another. A pixel is the mean over
// samples_per_axis^2 rays spread evenly over its area and, in the same order, over the sub-frames of the exposure. It
// is one ray if the strip shows a single static solid with a smooth pattern. The camera encodes light by its square
// root, which makes the shot noise independent of brightness (Anscombe 1948).
//
//   rays_x, rays_y [height, width]: x', y' of the pixel centres; pitch: their step between pixels
//   tiles [height / TILE_ROWS, width / LANES], strips [height, width / LANES]: min x', max x', min y', max y' of rays
//   solids [subframes, count, SOLID_FLOATS], near ones first; bounds cover all sub-frames
//   color [height, width, 3]: RGB
//
// Needs pixel_vectors.clh, solids.clh, visible_solids.clh, surface.clh, image_noise.clh.
//
// -D TILE_ROWS=8
// -D MAX_SOLIDS: see visible_solids.clh
#ifndef TILE_ROWS
#define TILE_ROWS 8
#endif

ALWAYS_INLINE lanes3 trace(__global const float* solids, const int* visible, int count, lanes x,
                           lanes y) {
  lanes nearest = FAR;
  lanes3 color = {0.0f, 0.0f, 0.0f};
  for (int i = 0; i < count; ++i) {
    __global const float* s = solids + visible[i] * SOLID_FLOATS;
    if (is_hidden(s, nearest)) continue;
    const lanes3 d = direction_in_shape(s, x, y);
    const lanes t = hit_solid(s, d);
    const lane_mask nearer = t < nearest;
    if (!ANY(nearer)) continue;
    const lanes light = brightness(s, point_on_ray(s, d, t));
    nearest = min(t, nearest);
    color.x = nearer ? light * s[COLOR] : color.x;
    color.y = nearer ? light * s[COLOR + 1] : color.y;
    color.z = nearer ? light * s[COLOR + 2] : color.z;
  }
  return color;
}

ALWAYS_INLINE lane_words encode(lanes light, float scale, lanes noise) {
  return convert_uint16(clamp(255.0f * sqrt(max(light * scale, 0.0f)) + noise, 0.0f, 255.0f) +
                        0.5f);
}

// Stores 16 interleaved RGB pixels; three words hold four pixels.
ALWAYS_INLINE void store_pixels(__global uchar* color, lane_words r, lane_words g, lane_words b) {
  const lane_words pixels = r | g << 8 | b << 16;
  const uint4 p0 = pixels.s048c, p1 = pixels.s159d, p2 = pixels.s26ae, p3 = pixels.s37bf;
  const uint4 a = p0 | p1 << 24, c = p1 >> 8 | p2 << 16, e = p2 >> 16 | p3 << 8;
  vstore4((uint4)(a.x, c.x, e.x, a.y), 0, (__global uint*)color);
  vstore4((uint4)(c.y, e.y, a.z, c.z), 1, (__global uint*)color);
  vstore4((uint4)(e.z, a.w, c.w, e.w), 2, (__global uint*)color);
}

// Number of rays along each side of a pixel.
ALWAYS_INLINE int rays_per_axis(__global const float* solids, const int* visible, int seen,
                                int wanted) {
  if (seen != 1) return wanted;
  __global const float* s = solids + visible[0] * SOLID_FLOATS;
  return s[MOVES] == 0.0f && s[PATTERN] != CHESSBOARD ? 1 : wanted;
}

// Sum of the light over axis^2 rays through each pixel.
ALWAYS_INLINE lanes3 gather(__global const float* solids, int count, int subframes,
                            const int* visible, int seen, lanes x, lanes y, float2 pitch,
                            int axis) {
  const int samples = axis * axis;
  lanes3 sum = {0.0f, 0.0f, 0.0f};
  for (int i = 0; i < samples; ++i) {
    const float u = (i % axis + 0.5f) / axis - 0.5f, v = (i / axis + 0.5f) / axis - 0.5f;
    __global const float* then = solids + (i * subframes / samples) * count * SOLID_FLOATS;
    const lanes3 light = trace(then, visible, seen, x + u * pitch.x, y + v * pitch.y);
    sum.x += light.x, sum.y += light.y, sum.z += light.z;
  }
  return sum;
}

__kernel void render_color(__global const float* rays_x, __global const float* rays_y,
                           __global const float4* tiles, __global const float4* strips,
                           __global const float* solids, int count, int subframes,
                           int samples_per_axis, float2 pitch, float gain, float noise_counts,
                           uint2 key, int width, int height, __global uchar* color) {
  const int column = get_global_id(0), columns = get_global_size(0);
  const int first_row = get_global_id(1) * TILE_ROWS;
  int in_tile[MAX_SOLIDS], in_strip[MAX_SOLIDS];
  const int candidates = visible_solids(
      solids, count, subframes, tiles[get_global_id(1) * columns + column], 0, count, in_tile);
  for (int row = first_row; row < min(first_row + TILE_ROWS, height); ++row) {
    const int* visible = in_tile;
    int seen = candidates;
    if (candidates > 1) {
      seen = visible_solids(solids, count, subframes, strips[row * columns + column], in_tile,
                            candidates, in_strip);
      visible = in_strip;
    }
    const int pixel = row * width + column * LANES;
    const int axis = rays_per_axis(solids, visible, seen, samples_per_axis);
    const lanes3 light = gather(solids, count, subframes, visible, seen, load_lanes(rays_x + pixel),
                                load_lanes(rays_y + pixel), pitch, axis);
    const philox_block random = philox(pixel, 0, key);
    const float scale = gain / (axis * axis);
    store_pixels(color + 3 * pixel, encode(light.x, scale, noise_counts * nearly_normal(random.w0)),
                 encode(light.y, scale, noise_counts * nearly_normal(random.w1)),
                 encode(light.z, scale, noise_counts * nearly_normal(random.w2)));
  }
}
