#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/cl/opencl.h"

namespace touchtrace {

/// Properties of an OpenCL device.
struct DeviceInfo {
  int number;                                        ///< index in list_devices(), for --device
  std::string name, vendor, platform, driver, type;  ///< type: "cpu", "gpu", "accelerator"
  int compute_units;
  std::uint64_t memory_bytes;
  bool has_doubles, is_pocl;
  cl::Device handle;
};

/// All devices of all platforms; empty without OpenCL. Skips platforms and devices whose driver
/// reports an error.
std::vector<DeviceInfo> list_devices();

/// The device that a number, or else a type ("cpu", "gpu"), or else a part of a name selects;
/// nullptr: none.
const DeviceInfo* find_device(const std::vector<DeviceInfo>& devices, const std::string& selector);

struct ChosenDevice {
  DeviceInfo info;
  std::string reason;  ///< why it was chosen, for the user
};

/// Chooses a device. `selector`: as of find_device(); empty: GPUs before accelerators before CPUs,
/// then by compute units. Throws device_error, which lists the
/// devices, if none matches.
ChosenDevice choose_device(const std::string& selector);

/// Chooses the device with the lowest latency of small launches: PoCL's "basic" device, which runs
/// kernels in the calling thread instead of waking another one; choose_device("") without PoCL.
/// Must be the process's first use of OpenCL, because it sets the environment variable by which
/// PoCL decides which devices to offer.
ChosenDevice choose_device_for_small_steps();

}  // namespace touchtrace
