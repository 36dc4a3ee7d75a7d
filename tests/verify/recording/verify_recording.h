#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Processor time a frame of writing and reading, bytes a frame, and what bit flips and a killed
/// writer do to a recording. Works in a temporary folder.
Verification verify_recording();

}  // namespace touchtrace
