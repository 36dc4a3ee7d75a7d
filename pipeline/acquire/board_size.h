#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// Size of the chessboard in the images: the one that most of them show, of equally frequent ones
/// the largest. Reads images until it is clear. Throws data_error if none shows a chessboard.
BoardSize find_board_size(const std::vector<std::filesystem::path>& images);

/// Notices early that the images show a board of another size than was asked for.
class BoardSizeCheck {
 public:
  explicit BoardSizeCheck(const CalibrationTarget& asked) : asked_(asked) {}

  /// Throws data_error if hardly an image so far shows the board, and one shows another.
  void add(const GreyImage& image, bool is_found, const std::filesystem::path& path);
  /// Many views that show a part of the board are no reason, if enough show all of it.
  void finish() const;

 private:
  void require_no_other() const;

  CalibrationTarget asked_;
  std::optional<BoardSize> seen_;
  std::string image_;
  int found_ = 0, missed_ = 0;
};

}  // namespace touchtrace
