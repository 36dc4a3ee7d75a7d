// A colour image of solids: Lambert shading, surface patterns, motion blur, sensor noise.
//
// One work-item renders a tile of LANES x TILE_ROWS pixels. A pixel is the mean over
// samples_per_axis^2 rays spread evenly over its area and, in the same order, over the sub-frames
// of the exposure; one ray where the tile holds a single solid of a smooth pattern. The camera
// encodes light by its square root, which turns shot noise into noise of the same size at every
// brightness (Anscombe 1948).
//
// rays_x, rays_y [height, width]: x', y' of each pixel's centre; pitch: their step between pixels.
// tiles [height / TILE_ROWS, width / LANES]: x' low, high, y' low, high of a tile's rays.
// solids [subframes, count, SOLID_FLOATS], near ones first; bounds span all sub-frames.
// color [height, width, 3]: RGB.
//
// -D TILE_ROWS=8, -D MAX_SOLIDS=96
#ifndef TILE_ROWS
#define TILE_ROWS 8
#endif
#ifndef MAX_SOLIDS
#define MAX_SOLIDS 96
#endif

enum { PLAIN, CLOTH, CHESSBOARD };

// A smooth wave of period 1 between 0 and 1.
ALWAYS_INLINE lanes wave(lanes x) {
  const lanes u = x - floor(x);
  return 4.0f * u * (1.0f - u);
}

ALWAYS_INLINE lanes cloth(__global const float* s, lanes3 p) {
  const float f = s[PATTERN + 2];
  const lanes coarse =
      wave(f * p.x + 0.31f * f * p.z) + wave(f * p.y) + wave(f * p.z - 0.27f * f * p.x);
  return 1.0f + s[PATTERN + 1] * (coarse - 2.0f);
}

// A board in the shape's x-y plane: squares of alternating colour around the origin, white around
// them.
ALWAYS_INLINE lanes chessboard(__global const float* s, lanes3 p) {
  const float square = s[PATTERN + 1], columns = s[PATTERN + 2], rows = s[PATTERN + 3];
  const lanes u = p.x / square + 0.5f * columns, v = p.y / square + 0.5f * rows;
  const lanes parity = floor(u) + floor(v);
  const lane_mask dark = parity - 2.0f * floor(0.5f * parity) < 0.5f;
  const lane_mask inside = u > 0.0f && u < columns && v > 0.0f && v < rows;
  return (dark && inside) ? (lanes)0.06f : (lanes)1.0f;
}

ALWAYS_INLINE lanes pattern_at(__global const float* s, lanes3 p) {
  switch ((int)s[PATTERN]) {
    case CLOTH:
      return cloth(s, p);
    case CHESSBOARD:
      return chessboard(s, p);
    default:
      return 1.0f;
  }
}

ALWAYS_INLINE lanes3 box_normal(__global const float* s, lanes3 p) {
  const lanes x = fabs(p.x) / s[SIZE], y = fabs(p.y) / s[SIZE + 1], z = fabs(p.z) / s[SIZE + 2];
  const lane_mask is_x = x >= y && x >= z, is_y = y > x && y >= z;
  lanes3 n;
  n.x = is_x ? sign(p.x) : (lanes)0.0f;
  n.y = is_y ? sign(p.y) : (lanes)0.0f;
  n.z = (is_x || is_y) ? (lanes)0.0f : sign(p.z);
  return n;
}

ALWAYS_INLINE lanes3 round_normal(__global const float* s, lanes3 p) {
  const int kind = (int)s[KIND];
  const float half_length = kind == SPHERE ? 0.0f : s[SIZE + 1], scale = 1.0f / s[SIZE];
  const lane_mask cap = (kind == CYLINDER) && fabs(p.z) > half_length - 1e-5f;
  const lanes z =
      kind == CYLINDER ? (lanes)0.0f : (p.z - clamp(p.z, -half_length, half_length)) * scale;
  lanes3 n;
  n.x = cap ? (lanes)0.0f : p.x * scale;
  n.y = cap ? (lanes)0.0f : p.y * scale;
  n.z = cap ? sign(p.z) : z;
  return n;
}

// Light reflected: ambient and one lamp, whose direction in the camera's frame is `lamp`.
ALWAYS_INLINE lanes brightness(__global const float* s, lanes3 p, float3 lamp) {
  const lanes3 n = (int)s[KIND] == BOX ? box_normal(s, p) : round_normal(s, p);
  const float3 l = {dot(vload3(0, s), lamp), dot(vload3(1, s), lamp), dot(vload3(2, s), lamp)};
  return (0.45f + 0.55f * max(n.x * l.x + n.y * l.y + n.z * l.z, 0.0f)) * pattern_at(s, p);
}

ALWAYS_INLINE lanes3 trace(__global const float* solids, const int* visible, int count, lanes x,
                           lanes y, float3 lamp) {
  lanes nearest = FAR;
  lanes3 color = {0.0f, 0.0f, 0.0f};
  for (int i = 0; i < count; ++i) {
    __global const float* s = solids + visible[i] * SOLID_FLOATS;
    if (is_hidden(s, nearest)) continue;
    const lanes3 d = direction_in_shape(s, x, y);
    const lanes t = hit_solid(s, d);
    const lane_mask nearer = t < nearest;
    if (!any(nearer)) continue;
    const lanes light = brightness(s, point_on_ray(s, d, t), lamp);
    nearest = min(t, nearest);
    color.x = nearer ? light * s[COLOR] : color.x;
    color.y = nearer ? light * s[COLOR + 1] : color.y;
    color.z = nearer ? light * s[COLOR + 2] : color.z;
  }
  return color;
}

ALWAYS_INLINE uchar16 encode(lanes light, float scale, lanes noise) {
  return convert_uchar16(
      clamp(rint(255.0f * sqrt(max(light * scale, 0.0f)) + noise), 0.0f, 255.0f));
}

// Sixteen pixels, colours side by side.
ALWAYS_INLINE void store_pixels(__global uchar* color, uchar16 r, uchar16 g, uchar16 b) {
  vstore16((uchar16)(r.s0, g.s0, b.s0, r.s1, g.s1, b.s1, r.s2, g.s2, b.s2, r.s3, g.s3, b.s3, r.s4,
                     g.s4, b.s4, r.s5),
           0, color);
  vstore16((uchar16)(g.s5, b.s5, r.s6, g.s6, b.s6, r.s7, g.s7, b.s7, r.s8, g.s8, b.s8, r.s9, g.s9,
                     b.s9, r.sa, g.sa),
           1, color);
  vstore16((uchar16)(b.sa, r.sb, g.sb, b.sb, r.sc, g.sc, b.sc, r.sd, g.sd, b.sd, r.se, g.se, b.se,
                     r.sf, g.sf, b.sf),
           2, color);
}

__kernel void render_color(__global const float* rays_x, __global const float* rays_y,
                           __global const float4* tiles, __global const float* solids, int count,
                           int subframes, int samples_per_axis, float2 pitch, float4 lamp_and_gain,
                           float noise_counts, uint2 key, int width, int height,
                           __global uchar* color) {
  const int column = get_global_id(0) * LANES, first_row = get_global_id(1) * TILE_ROWS;
  int visible[MAX_SOLIDS] = {0};
  const int seen = visible_solids(
      solids, count, subframes, tiles[get_global_id(1) * get_global_size(0) + get_global_id(0)], visible);
  const bool has_edges = seen > 1 || solids[visible[0] * SOLID_FLOATS + PATTERN] == CHESSBOARD;
  const int axis = has_edges ? samples_per_axis : 1, samples = axis * axis;
  for (int row = first_row; row < min(first_row + TILE_ROWS, height); ++row) {
    const int pixel = row * width + column;
    const lanes x = load_lanes(rays_x + pixel), y = load_lanes(rays_y + pixel);
    lanes3 sum = {0.0f, 0.0f, 0.0f};
    for (int i = 0; i < samples; ++i) {
      const float u = (i % axis + 0.5f) / axis - 0.5f, v = (i / axis + 0.5f) / axis - 0.5f;
      const lanes3 c = trace(solids + (i * subframes / samples) * count * SOLID_FLOATS, visible,
                             seen, x + u * pitch.x, y + v * pitch.y, lamp_and_gain.xyz);
      sum.x += c.x, sum.y += c.y, sum.z += c.z;
    }
    const philox_block random = philox(pixel, 0, key);
    const float scale = lamp_and_gain.w / samples;
    store_pixels(color + 3 * pixel, encode(sum.x, scale, noise_counts * nearly_normal(random.w0)),
                 encode(sum.y, scale, noise_counts * nearly_normal(random.w1)),
                 encode(sum.z, scale, noise_counts * nearly_normal(random.w2)));
  }
}
