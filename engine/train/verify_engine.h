#pragma once

#include "engine/base/figure.h"

namespace touchtrace {

/// The rows of `touchtrace verify engine`, measured on the device chosen by default.
Verification verify_engine();

}  // namespace touchtrace
