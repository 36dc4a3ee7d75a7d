#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Flips bits of a log, a model and a calibration. `folder`: for the files.
void measure_flips(const std::filesystem::path& folder, const std::function<void(Figure)>& emit);

}  // namespace touchtrace
