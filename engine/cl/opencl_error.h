#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/cl/opencl.h"

namespace touchtrace {

/// "CL_OUT_OF_RESOURCES (-5)"
std::string opencl_error_name(cl_int code);

/// device_error for a failed OpenCL call: "ACTION failed on DEVICE: ...". For error codes that mean
/// out of memory the hint names options that reduce memory use.
Error opencl_error(const cl::Error& error, std::string_view action, const std::string& device);

}  // namespace touchtrace
