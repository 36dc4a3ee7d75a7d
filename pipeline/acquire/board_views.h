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

/// True for a folder with rgb.txt and depth.txt, as the TUM RGB-D benchmark has them.
bool is_tum_folder(const std::filesystem::path& folder);

/// The board in such a folder: colour images with the depth images nearest in time, 16-bit PNG of
/// 5000 counts a metre. Of a long video some 40 pairs of successive frames, spread evenly. Throws
/// data_error for a fault.
BoardObservations board_views_of_tum(const std::filesystem::path& folder, const Chessboard& board);

/// An image as grey values. Throws data_error if it cannot be read.
GreyImage read_grey(const std::filesystem::path& path);

/// Throws data_error if the image does not have the size of those before it.
void require_same_size(const BoardObservations& observations, const GreyImage& image,
                       const std::filesystem::path& path);

/// The files that board_views_of_images or board_views_of_tum reads.
std::vector<std::filesystem::path> image_files(const std::string& folder_or_pattern);

}  // namespace touchtrace
