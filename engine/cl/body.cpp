#include "engine/cl/body.h"

namespace touchtrace {
namespace {

// The largest of all kernels with lanes.
constexpr std::size_t lanes_items = 256, lanes_local_bytes = 32 * 1024;

}  // namespace

bool has_room_for_lanes(const DeviceInfo& device) {
  return device.handle.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>() >= lanes_items &&
         device.handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>() >= lanes_local_bytes;
}

Body body_for(const DeviceInfo& device) {
  return device.type == "gpu" && has_room_for_lanes(device) ? Body::lanes : Body::vectors;
}

}  // namespace touchtrace
