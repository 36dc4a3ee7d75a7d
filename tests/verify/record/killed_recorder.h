#pragma once

#include <cstdint>
#include <filesystem>

namespace touchtrace {

struct KilledRecorder {
  std::uint64_t acknowledged_frames = 0;  ///< written when the process was killed
  std::uint64_t recovered_frames = 0;
  bool is_complete = false;  ///< the recovered recording is valid and nothing but its end was torn
};

/// Records, in a process of its own, a glove on a pseudo-terminal that sends frames at 100 Hz, ten
/// times its rate; kills the process after `after_s`, and recovers its log in `folder`.
KilledRecorder kill_recorder(const std::filesystem::path& folder, double after_s);

}  // namespace touchtrace
