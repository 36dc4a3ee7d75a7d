#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/board/board_detector.h"
#include "calib/board/chessboard.h"

namespace touchtrace {

/// Size of the chessboard in the images: the one with the most corners in all of them. Reads images
/// until it is clear. Throws data_error if none shows a chessboard, or too few show one of that
/// size.
BoardSize find_board_size(const std::vector<std::filesystem::path>& images);

/// Size of the chessboard of calibration.json; nullopt for another file or target. Throws
/// data_error if it is not a size.
std::optional<BoardSize> board_size_of_corners(const std::filesystem::path& file);

/// Reports a chessboard with markers, if one of the first images shows it.
void report_markers(const std::vector<std::filesystem::path>& images);

/// Notices early that the images show another target than was asked for.
class OtherTargetCheck {
 public:
  explicit OtherTargetCheck(const CalibrationTarget& asked) : asked_(asked) {}

  /// Throws data_error if hardly an image so far shows the target, and one shows another.
  void add(const GreyImage& image, BoardFound found, const std::filesystem::path& path);
  /// `views`: those that can be used. Throws data_error if there are too few, and an image shows
  /// another target.
  void finish(std::size_t views);

 private:
  void probe(const GreyImage& image, const std::filesystem::path& path);
  void require_no_other();

  CalibrationTarget asked_;
  std::optional<OtherTarget> other_;
  std::string image_;                      ///< that shows the other target
  std::optional<GreyImage> missed_image_;  ///< in which other kinds are looked for if need be
  bool is_recognized_ = false;             ///< whether they were
  int found_ = 0, missed_ = 0, probed_ = 0;
};

}  // namespace touchtrace
