#pragma once

#include "engine/cl/device.h"

namespace touchtrace::cli {

/// choose_device(wish), and proof that it works: unless PoCL is all that is installed, another
/// process loads every OpenCL driver and tests the device first, since a bad driver crashes, hangs
/// or computes wrong values. Then PoCL is used instead, with a warning on stderr. To be called
/// before anything else uses OpenCL. Throws device_error if there is no PoCL either.
ChosenDevice usable_device(const std::string& wish);

}  // namespace touchtrace::cli
