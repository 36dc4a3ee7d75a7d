#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "pipeline/acquire/record/log.h"

namespace touchtrace {

struct LogConversion {
  LogDamage damage;
  std::uint64_t unusable_records = 0;  ///< valid, but of unknown kind, size or order
  std::size_t glove_frames = 0, lost_glove_frames = 0, color_images = 0, depth_images = 0,
              clips = 0;
  double duration_s = 0.0;

  /// False if frames that were recorded are missing.
  bool is_complete() const { return damage.is_torn_only() && unusable_records == 0; }
  /// "300 glove frames (2 lost), ..."
  std::string text() const;
};

nlohmann::json to_json(const LogConversion& conversion);

/// Converts a log to a recording, with one clip for each time that the glove was connected. Reports
/// what is damaged. Throws data_error if the log has no frames.
LogConversion convert_log(const std::filesystem::path& log, const std::filesystem::path& output,
                          bool overwrite);

}  // namespace touchtrace
