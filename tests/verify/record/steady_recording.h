#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace {

struct SteadyRecording {
  double wall_s = 0.0, cpu_s = 0.0, duration_s = 0.0;  ///< duration_s: recorded
  std::uint64_t discarded_frames = 0;                  ///< because the disk was too slow
  std::uint64_t missing_frames = 0;                    ///< sent by a device, but not in the log
  std::vector<double> memory_bytes;                    ///< resident; median of each recorded hour
};

/// Records a camera of 640 x 480 pixels, colour and depth at 30 Hz, and a glove of 32 x 32 taxels
/// at 15 Hz on a pseudo-terminal, at `speed` times these rates. With a speed above 1, what was
/// written is removed from the log at once, because 8 hours would need 1.3 TB. Ctrl-C ends it.
SteadyRecording record_steadily(const std::filesystem::path& folder, double duration_s,
                                double speed);

/// Records 10 s.
void measure_load(const std::filesystem::path& folder, const std::function<void(Figure)>& emit);

/// Records 8 hours at 10 times the rates, into memory (/dev/shm) where that is possible, or until
/// Ctrl-C. The rates themselves, on the disk, are those of measure_load().
Verification verify_hours();

}  // namespace touchtrace
