#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Latency and bits of live predictions, crashes while recording, damaged logs, random bytes for
/// the parsers, and the load of recording.
Verification verify_record();

}  // namespace touchtrace
