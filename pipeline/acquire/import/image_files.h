#pragma once

#include "pipeline/acquire/import/source.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Streams of image files, one image per file. Depth: 16-bit PNG or TIFF, or arrays (.npy, .npz).
SourceStream color_file_stream(std::vector<StampedFile> files);
SourceStream depth_file_stream(std::vector<StampedFile> files);

}  // namespace touchtrace
