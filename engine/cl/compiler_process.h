#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/child_process.h"
#include "engine/cl/opencl.h"

namespace touchtrace {

/// Kernels of a built program to be compiled by another process: PoCL compiles a kernel on its
/// first launch, in one thread.
struct CompilerTask {
  int device;  ///< DeviceInfo::number
  std::string options, source;
  std::vector<std::string> kernels;
};

/// Registers the arguments with which this executable runs compile_from_stdin().
void register_compiler_arguments(std::vector<std::string> arguments);

/// Starts a process that compiles the kernels into the driver's disk cache, last kernel first,
/// while this process compiles them on demand, first kernel first. Each loads from the cache what
/// the other has compiled. If the process fails, only time is lost. Returns null if no arguments
/// are registered.
std::unique_ptr<BackgroundProcess> start_compiler(const CompilerTask& task);

/// Entry point of that process: compile_kernels() with the task on stdin.
void compile_from_stdin();
/// Launches each kernel once with zero-valued arguments. Throws cl::Error.
void compile_kernels(const CompilerTask& task);

}  // namespace touchtrace
