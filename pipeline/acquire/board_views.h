#pragma once

#include <filesystem>
#include <string>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// The board views of a recording: corners in the colour images, and the depth images. Throws
/// data_error if the recording has none.
BoardObservations board_views_of_recording(const std::filesystem::path& recording);

/// The board in every image of a folder or of a pattern like `photos/left*.jpg`, sorted by name; no
/// depth. Throws data_error if there are no images, one cannot be read, or their sizes differ.
BoardObservations board_views_of_images(const std::string& folder_or_pattern,
                                        const Chessboard& board);

/// The files that board_views_of_images reads.
std::vector<std::filesystem::path> image_files(const std::string& folder_or_pattern);

}  // namespace touchtrace
