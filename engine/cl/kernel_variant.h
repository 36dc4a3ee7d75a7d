#pragma once

#include "engine/cl/device.h"

namespace touchtrace {

/// Implementation of the compute-bound kernels.
/// `cpu`: one work-item computes a tile in explicit vectors, without barriers
/// (kernels/cpu_tile.clh). `gpu`: one work-group computes a tile through local memory
/// (kernels/gpu_tile.clh).
enum class KernelVariant { cpu, gpu };

/// Whether the device's work-group size and local memory suffice for KernelVariant::gpu.
bool supports_gpu_variant(const DeviceInfo& device);

/// KernelVariant::gpu on GPUs that support it, else KernelVariant::cpu.
KernelVariant default_variant(const DeviceInfo& device);

}  // namespace touchtrace
