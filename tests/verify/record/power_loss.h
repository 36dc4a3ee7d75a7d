#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Loses power 1,000 times while a glove is recorded at ten times its rate. What the recorder
/// synchronised is intact. Behind it, a file either ends at any byte, or each block of 4 KiB is as
/// written, zero, or random: the states in which journalling file systems leave a file that grew.
void measure_power_losses(const std::filesystem::path& folder,
                          const std::function<void(Figure)>& emit);

}  // namespace touchtrace
