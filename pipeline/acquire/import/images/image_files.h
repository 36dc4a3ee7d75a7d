#pragma once

#include "pipeline/acquire/import/source/source.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Streams of image files, one image per file. Depth: 16-bit PNG or TIFF, or arrays (.npy, .npz,
/// .mat).
SourceStream color_file_stream(std::vector<StampedFile> files);
SourceStream depth_file_stream(std::vector<StampedFile> files);

/// Files of a folder that may be arrays of depth, one per image.
std::vector<std::filesystem::path> depth_array_files(const std::filesystem::path& folder);

}  // namespace touchtrace
