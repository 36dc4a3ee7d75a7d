#pragma once

#include <filesystem>
#include <vector>

namespace touchtrace {

/// Image files of one camera in the order that their names tell.
struct NamedImages {
  std::vector<std::filesystem::path> files;
  /// [files] times in the names: seconds since 1970 of dates, or stamps of an unknown unit, which
  /// have a fraction or 13 digits or more. Empty: the names have none.
  std::vector<double> stamps;
  std::vector<double> numbers;     ///< [files] of frames; empty: none, or the names have stamps
  bool has_dates = false;          ///< the stamps are dates
  bool has_whole_seconds = false;  ///< dates without a fraction, which a counter may look like
  bool numbers_disagree = false;   ///< about the order
};

/// Orders files by the dates in their names, else by the last number that differs between the
/// names ("frame_12_640x480": 12). If several differ and disagree about the order, the first ones
/// decide, and none counts frames. Files without numbers are ordered by their names.
NamedImages order_by_name(std::vector<std::filesystem::path> files);

}  // namespace touchtrace
