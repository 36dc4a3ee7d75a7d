#include "engine/cl/runtime.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/cl/kernel_sources.h"

namespace touchtrace {
namespace {

std::string option_text(const Defines& defines, Accuracy accuracy) {
  std::string text = "-cl-std=CL1.2";
  if (accuracy == Accuracy::fast) text += " -cl-denorms-are-zero";
  if (accuracy == Accuracy::exact) text += " -D EXACT=1";
  for (const auto& [name, value] : defines) text += fmt::format(" -D {}={}", name, value);
  return text;
}

}  // namespace

Runtime::Runtime(ChosenDevice device, Accuracy accuracy)
    : device_(std::move(device)),
      accuracy_(accuracy),
      context_(device_.info.handle),
      queue_(context_, device_.info.handle) {}

cl::Kernel Runtime::kernel(const std::vector<std::string>& files, const std::string& name,
                           const Defines& defines) {
  const std::string options = option_text(defines, accuracy_);
  const std::string key = comma_separated(files) + " " + options;
  auto found = programs_.find(key);
  if (found == programs_.end()) found = programs_.emplace(key, build(files, options)).first;
  return cl::Kernel(found->second, name.c_str());
}

cl::Program Runtime::build(const std::vector<std::string>& files, const std::string& options) {
  std::string source;
  for (const auto& file : files) source += kernel_sources().at(file);
  cl::Program program(context_, source);
  try {
    program.build({device_.info.handle}, options.c_str());
  } catch (const cl::Error&) {
    throw device_error(fmt::format("{} does not build for {} with {}:\n{}", comma_separated(files),
                                   device_.info.name, options,
                                   program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_.info.handle)),
                       "choose another device with --device, and report this log");
  }
  return program;
}

cl::Buffer Runtime::allocate_bytes(std::size_t bytes) {
  return cl::Buffer(context_, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 1));
}

}  // namespace touchtrace
