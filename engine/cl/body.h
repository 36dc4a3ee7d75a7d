#pragma once

#include "engine/cl/device.h"

namespace touchtrace {

/// How the hot kernels are written: `vectors`, for CPUs, computes a tile of explicit vectors a
/// work-item, without barriers; `lanes`, for GPUs, a tile a work-group, through local memory
/// (kernels/lanes.clh).
enum class Body { vectors, lanes };

/// Whether the device's work-groups and local memory are large enough for `lanes`.
bool has_room_for_lanes(const DeviceInfo& device);

/// `lanes` on a GPU that has room for it, else `vectors`.
Body body_for(const DeviceInfo& device);

}  // namespace touchtrace
