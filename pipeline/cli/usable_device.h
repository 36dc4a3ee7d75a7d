#pragma once

#include "engine/cl/device.h"

namespace touchtrace::cli {

/// Returns choose_device(selector) after a child process has tested the device: a bad driver
/// crashes, hangs or computes wrong values. Skips the test if only PoCL is installed.
///
/// If the test fails: throws device_error for a named device; for the default one (empty
/// `selector`) warns on stderr and returns PoCL, or throws device_error without PoCL. Call it
/// before anything else uses OpenCL.
ChosenDevice usable_device(const std::string& selector);

/// Device for predictions of single frames: usable_device() of a named device, else that of
/// choose_device_for_small_steps(), for which no other driver than PoCL is loaded.
ChosenDevice usable_device_for_small_steps(const std::string& selector);

}  // namespace touchtrace::cli
