#include "engine/cl/kernel_variant.h"

namespace touchtrace {
namespace {

// Largest work-group and local memory of any kernel of KernelVariant::gpu.
constexpr std::size_t max_work_group_size = 256, max_local_bytes = 32 * 1024;

}  // namespace

bool supports_gpu_variant(const DeviceInfo& device) {
  return device.handle.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>() >= max_work_group_size &&
         device.handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>() >= max_local_bytes;
}

KernelVariant default_variant(const DeviceInfo& device) {
  return device.type == "gpu" && supports_gpu_variant(device) ? KernelVariant::gpu
                                                              : KernelVariant::cpu;
}

}  // namespace touchtrace
