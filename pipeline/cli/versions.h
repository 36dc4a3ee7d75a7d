#pragma once

#include <string>

namespace touchtrace::cli {

/// Argument with which version_text() starts this program to print opencl_versions().
inline constexpr const char* print_opencl_versions = "print-opencl-versions";

/// Version of the program and the commit that it was built from.
std::string program_version();

/// Versions of the program (with its commit), of the OpenCL platforms and drivers, and of the
/// libraries, one per line. Loads OpenCL drivers in a child process: bad ones crash or hang.
std::string version_text(const std::string& program);

/// One line per OpenCL device: name, platform version, driver version.
std::string opencl_versions();

}  // namespace touchtrace::cli
