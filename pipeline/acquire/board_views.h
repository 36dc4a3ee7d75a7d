#pragma once

#include <filesystem>
#include <string>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// Detects the board in the board views of a recording; with depth images. Throws data_error if the
/// recording has no views.
BoardObservations board_views_from_recording(const std::filesystem::path& recording);

/// Detects the board in the images of a folder or of a pattern such as `photos/left*.jpg`, sorted
/// by name; no depth. Throws data_error if there are no images, one is unreadable, or sizes differ.
BoardObservations board_views_from_images(const std::string& folder_or_pattern,
                                          const Chessboard& board);

/// True for a folder in the format of the TUM RGB-D benchmark: with rgb.txt and depth.txt.
bool is_tum_folder(const std::filesystem::path& folder);

/// Detects the board in a TUM RGB-D folder. Depth images are 16-bit PNG, 5000 counts per metre. See
/// select_tum_pairs for long videos. Throws data_error.
BoardObservations board_views_from_tum(const std::filesystem::path& folder,
                                       const Chessboard& board);

/// Reads an image as grey values. Throws data_error if that fails.
GreyImage read_grey(const std::filesystem::path& path);

/// Throws data_error unless the image has the size of the previous ones.
void require_same_size(const BoardObservations& observations, const GreyImage& image,
                       const std::filesystem::path& path);

/// Files that board_views_from_images or board_views_from_tum reads.
std::vector<std::filesystem::path> image_files(const std::string& folder_or_pattern);

}  // namespace touchtrace
