#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/child_process.h"
#include "engine/cl/opencl.h"

namespace touchtrace {

/// Kernels of a program that the driver has built, but not compiled: PoCL compiles each one when it
/// is first launched, in one thread.
struct CompilerTask {
  int device;  ///< its number
  std::string options, source;
  std::vector<std::string> kernels;
};

/// Says that this program, called with `arguments`, does compile_from_stdin().
void offer_compiler_process(std::vector<std::string> arguments);

/// Another process that compiles the kernels, the last one first, into the driver's cache on disk,
/// while this one takes them as it needs them: what the cache holds by then is loaded from there.
/// If that process fails, nothing is lost but time. Null where nobody offered one.
std::unique_ptr<BackgroundProcess> start_compiler(const CompilerTask& task);

/// That process: compile_kernels() of the task on stdin.
void compile_from_stdin();
/// Launches each kernel once, on numbers and arrays that are zero. Throws cl::Error.
void compile_kernels(const CompilerTask& task);

}  // namespace touchtrace
