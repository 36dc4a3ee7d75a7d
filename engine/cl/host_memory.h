#pragma once

#include <cstddef>

#include "engine/cl/opencl.h"

namespace touchtrace {

/// A buffer for a processor that computes in the host's memory, in huge pages where the system
/// gives them, since kernels stride through several MiB, more than small pages' addresses can be
/// kept at hand for. Throws cl::Error.
cl::Buffer huge_page_buffer(const cl::Context& context, std::size_t bytes);

}  // namespace touchtrace
