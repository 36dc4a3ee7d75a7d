#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Records a glove to a file system of 1 MB until it is full, and recovers the log. Without the
/// right to mount one, files of this process are limited to 1 MB instead.
void measure_full_disk(const std::filesystem::path& folder,
                       const std::function<void(Figure)>& emit);

}  // namespace touchtrace
