#pragma once

#include <string_view>

namespace touchtrace {

// What the words in the name of a file or folder say about its images. Case does not matter.

/// "depth", "depthMatrices", "aligned_depth_to_color", "dpt".
bool names_depth(std::string_view name);
/// Depth on the colour camera's pixels: "aligned_depth_to_color", "depth_registered".
bool names_registered_depth(std::string_view name);
/// "rgb", "color_image", "RGB_left", "Frames".
bool names_color(std::string_view name);
/// Images that are neither colour nor depth: masks, labels, normals, infrared, confidences.
bool names_other_image(std::string_view name);

}  // namespace touchtrace
