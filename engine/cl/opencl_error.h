#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/cl/opencl.h"

namespace touchtrace {

/// "CL_OUT_OF_RESOURCES (-5)"
std::string opencl_error_name(cl_int code);

/// The device_error for an OpenCL call that failed: what was being done, on which device, and what
/// to do. Codes that mean "out of memory" name the options that lower the need.
Error opencl_error(const cl::Error& error, std::string_view doing, const std::string& device);

}  // namespace touchtrace
