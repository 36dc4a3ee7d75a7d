#pragma once

#include <cstdint>
#include <filesystem>

namespace touchtrace {

struct KilledRecorder {
  std::uint64_t acknowledged_frames = 0;  ///< written when the process was killed
  std::uint64_t recovered_frames = 0;
  bool is_complete = false;  ///< the recovered recording is valid and nothing but its end was torn
};

struct KillCounts {
  std::uint64_t acknowledged_frames = 0, lost_frames = 0, incomplete_logs = 0;
};

/// Records, in a process of its own, a glove on a pseudo-terminal that sends frames at 100 Hz, ten
/// times its rate; kills the process after `after_s`, and recovers its log in `folder`.
KilledRecorder kill_recorder(const std::filesystem::path& folder, double after_s);
/// Kills a recorder `kills` times, 0.05 to 0.6 s after its start, in concurrent `processes`. A log
/// that could not be recovered, also because this crashed, is incomplete.
KillCounts kill_recorders(const std::filesystem::path& folder, int kills, int processes);

/// Records such a glove in this process. `start_s`: time of monotonic_s() that is 0 in the log.
void record_for(const std::filesystem::path& log, double start_s, double duration_s);

}  // namespace touchtrace
