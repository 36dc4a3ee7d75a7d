#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace {

// Groups of rows of `touchtrace-verify record`. `folder`: for their files.

/// Flips bits of a log, a model and a calibration.
void measure_flips(const std::filesystem::path& folder, const std::function<void(Figure)>& emit);

/// Records a glove to a file system of 1 MB until it is full, and recovers the log. Without the
/// right to mount one, files of this process are limited to 1 MB instead.
void measure_full_disk(const std::filesystem::path& folder,
                       const std::function<void(Figure)>& emit);

/// Loses power 1,000 times while a glove is recorded at ten times its rate. What the recorder
/// synchronised is intact. Behind it, a file either ends at any byte, or each block of 4 KiB is as
/// written, zero, or random: the states in which journalling file systems leave a file that grew.
void measure_power_losses(const std::filesystem::path& folder,
                          const std::function<void(Figure)>& emit);

/// Records a camera of 640 x 480 pixels, colour and depth at 30 Hz, and a glove of 32 x 32 taxels
/// at 15 Hz on a pseudo-terminal for 10 s.
void measure_load(const std::filesystem::path& folder, const std::function<void(Figure)>& emit);

}  // namespace touchtrace
