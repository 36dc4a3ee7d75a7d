#pragma once

#include <filesystem>

#include "engine/cl/device.h"
#include "engine/ops/tuning.h"

namespace touchtrace {

/// Where the choices of `touchtrace tune` are kept: touchtrace/tuning.json in $XDG_CACHE_HOME, or
/// else in ~/.cache (XDG Base Directory Specification 0.8). Empty if neither is set.
std::filesystem::path tuning_path();

/// The choices for a device, its driver and these kernels. None if there are none: if the file is
/// missing, damaged or another program's, or if the device's are of another driver or of other
/// kernels; but for the first a warning says so. Never throws for what a file holds.
Tuning read_tuning(const std::filesystem::path& path, const DeviceInfo& device);

/// Replaces the device's choices and leaves those of other devices. The file is whole at any
/// moment. Throws failure if it cannot be written.
void write_tuning(const std::filesystem::path& path, const DeviceInfo& device,
                  const Tuning& tuning);

}  // namespace touchtrace
