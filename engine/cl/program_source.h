#pragma once

#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// Values of the -D macros of a program module, by name.
using Defines = std::map<std::string, std::string>;

/// Files of kernels/, concatenated in this order, and the macros that they are compiled with.
struct ProgramModule {
  std::vector<std::string> files;
  Defines defines;
};

/// Name of a kernel of module `number` within combined_source().
std::string mangled_kernel_name(const std::string& kernel, int number);
/// Inverse of mangled_kernel_name().
std::string unmangled_kernel_name(const std::string& mangled);

/// Combines modules into one source, because drivers need far longer per program than per kernel.
/// OpenCL C has no namespaces: the names that a module defines at file scope get the module's
/// number appended, and its macros are undefined at its end.
std::string combined_source(const std::vector<ProgramModule>& modules);

}  // namespace touchtrace
