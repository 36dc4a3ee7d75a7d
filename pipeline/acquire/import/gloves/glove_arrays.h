#pragma once

#include <map>

#include "pipeline/acquire/import/formats/numpy_file.h"
#include "pipeline/acquire/import/gloves/glove_file.h"

namespace touchtrace {

/// Names that the arrays of a glove may have.
const std::vector<std::string>& glove_array_names();

/// Frames of a glove from arrays of times [frames] and counts [frames, rows, cols] or [frames,
/// taxels], and frame numbers if there are any. `file` is for messages. Throws data_error.
GloveFile glove_of_arrays(const std::map<std::string, NumpyArray>& arrays,
                          const std::filesystem::path& file, const GloveFileOptions& options);

}  // namespace touchtrace
