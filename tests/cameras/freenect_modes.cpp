// Loaded before fakenect, which plays images as they were recorded, whatever their mode, but knows
// the raw mode of depth alone: images in the dump are registered depth already.
#include <libfreenect.h>

#include <cstdlib>

extern "C" freenect_frame_mode freenect_find_depth_mode(freenect_resolution resolution,
                                                        freenect_depth_format format) {
  constexpr int width = 640, height = 480;
  static bool is_first = true;  // fakenect itself asks for the raw mode, later
  if (is_first && format != FREENECT_DEPTH_REGISTERED) std::abort();
  is_first = false;
  return {1, resolution, {format}, 2 * width * height, width, height, 16, 0, 30, 1};
}
