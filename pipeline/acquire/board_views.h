#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calib/board/chessboard.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Detects the board in the board views of a recording; with depth images. Throws data_error if the
/// recording has too few views.
BoardObservations board_views_from_recording(const std::filesystem::path& recording);

/// Detects the board in `count` views of a camera, which `read` returns; with depth images.
BoardObservations detect_board_views(const CameraInfo& camera, const BoardInfo& board,
                                     std::size_t count,
                                     const std::function<RgbdFrame(std::size_t)>& read);

/// Detects the board in images: files, folders and patterns such as `photos/left*.jpg`; no depth.
/// Pixels are used as stored, because a camera's sensor does not turn with the orientation in EXIF.
/// Files that are not images, and images of another size than most, are listed as skipped. Throws
/// data_error if there is no image.
BoardObservations board_views_from_images(const std::vector<std::string>& folders_or_patterns,
                                          const CalibrationTarget& board);

/// Reads corners that were detected before: calibration.json, or a text file of mrcal with the
/// lines `filename x y level`, the corners of an image along the board's rows, `-` where one was
/// not seen. The size of the images is in calibration.json; else the first image is read, relative
/// to the file. Throws data_error for an invalid file or corners that the board does not have.
BoardObservations board_views_from_corners(const std::filesystem::path& file,
                                           const CalibrationTarget& board);

/// True for a folder in the format of the TUM RGB-D benchmark: with rgb.txt and depth.txt.
bool is_tum_folder(const std::filesystem::path& folder);

/// Detects the board in a TUM RGB-D folder. Depth images are 16-bit PNG, 5000 counts per metre. See
/// select_tum_pairs for long videos. Throws data_error.
BoardObservations board_views_from_tum(const std::filesystem::path& folder,
                                       const CalibrationTarget& board);

/// Reads an image as grey values. Throws data_error if that fails.
GreyImage read_grey(const std::filesystem::path& path);

/// Throws data_error unless the image has the size of the first one.
void require_same_size(const GreyImage& first, const GreyImage& image,
                       const std::filesystem::path& path);

/// Images in a folder, by their extension, sorted; may be empty.
std::vector<std::filesystem::path> images_in_folder(const std::filesystem::path& folder);

/// Whether a path is a folder, or a file or pattern of files with the extension of an image.
bool may_be_images(const std::filesystem::path& path);
/// Throws data_error for the extension of a video.
void require_no_video(const std::filesystem::path& path);

/// Files that board_views_from_images or board_views_from_tum reads. Throws usage_error for a TUM
/// folder and other sources.
std::vector<std::filesystem::path> image_files(const std::vector<std::string>& folders_or_patterns);

}  // namespace touchtrace
