#pragma once

#include <cstddef>

#include "engine/cl/opencl.h"

namespace touchtrace {

/// Allocates a buffer in host memory for a CPU device, in huge pages if the system grants them:
/// kernels stride through several MiB, more than the TLB covers with small pages. Throws cl::Error.
cl::Buffer huge_page_buffer(const cl::Context& context, std::size_t bytes);

}  // namespace touchtrace
