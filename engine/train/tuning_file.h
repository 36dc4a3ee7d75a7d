#pragma once

#include <filesystem>

#include "engine/cl/device.h"
#include "engine/ops/tuning.h"

namespace touchtrace {

/// Path of the file that `touchtrace tune` writes: touchtrace/tuning.json in $XDG_CACHE_HOME, or
/// else in ~/.cache (XDG Base Directory Specification 0.8). Empty if neither is set.
std::filesystem::path tuning_path();

/// Reads the tuning for a device, its driver and the built-in kernels. Empty if the file is
/// missing. Empty with a warning if the file is damaged or not a tuning file, or if the device's
/// tuning is for another driver or other kernels. Never throws because of the contents.
Tuning read_tuning(const std::filesystem::path& path, const DeviceInfo& device);

/// Replaces the tuning of the device and keeps that of other devices. Atomic. Throws failure if the
/// file cannot be written.
void write_tuning(const std::filesystem::path& path, const DeviceInfo& device,
                  const Tuning& tuning);

}  // namespace touchtrace
