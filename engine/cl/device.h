#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/cl/opencl.h"

namespace touchtrace {

/// What is known of an OpenCL device without using it.
struct DeviceInfo {
  int number;                                        ///< place in list_devices(), for --device
  std::string name, vendor, platform, driver, type;  ///< type: "cpu", "gpu", "accelerator"
  int compute_units;
  std::uint64_t memory_bytes;
  bool has_doubles, is_pocl;
  cl::Device handle;
};

/// Every device of every platform; empty if there is no OpenCL at all. Never throws for a bad
/// driver.
std::vector<DeviceInfo> list_devices();

struct ChosenDevice {
  DeviceInfo info;
  std::string reason;  ///< one sentence for the user
};

/// `wish`: empty for the fastest usable device, or a number, a type ("cpu", "gpu") or a part of a
/// name. Throws device_error, listing what there is, if nothing fits.
ChosenDevice choose_device(const std::string& wish);

/// The device that answers a single small step soonest: PoCL's "basic", which runs kernels in the
/// thread that asks for them, where other devices have to wake another thread first; the fastest
/// device where PoCL is missing. PoCL offers it only if this is the process's first use of OpenCL.
ChosenDevice choose_device_for_small_steps();

}  // namespace touchtrace
