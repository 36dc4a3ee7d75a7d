#pragma once

#include <cstddef>

#include "engine/cl/opencl.h"

namespace touchtrace {

/// A buffer for a processor that computes in the host's memory, in huge pages where the system
/// gives them: kernels that stride through several MiB otherwise spend a fifth of their time on
/// page tables. Throws cl::Error.
cl::Buffer huge_page_buffer(const cl::Context& context, std::size_t bytes);

}  // namespace touchtrace
