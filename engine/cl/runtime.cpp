#include "engine/cl/runtime.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "engine/base/text.h"
#include "engine/cl/host_memory.h"
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

std::string build_log(const cl::Program& program, const cl::Device& device) {
  try {
    return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
  } catch (const cl::Error&) {
    return "(the driver gives no log)";
  }
}

using ByteCount = std::shared_ptr<std::atomic<std::size_t>>;

/// Adds `bytes` to `count` for as long as the buffer lives.
void count_until_released(cl::Buffer& buffer, std::size_t bytes, const ByteCount& count) {
  struct Release {
    std::size_t bytes;
    ByteCount count;
  };
  auto release = std::make_unique<Release>(Release{bytes, count});
  const auto on_release = [](cl_mem, void* data) {
    const std::unique_ptr<Release> owned(static_cast<Release*>(data));
    *owned->count -= owned->bytes;
  };
  buffer.setDestructorCallback(on_release, release.get());
  release.release();
  *count += bytes;
}

/// Memory in whole MiB, rounded up.
std::uint64_t mebibytes(std::uint64_t bytes) { return (bytes + (1u << 20) - 1) >> 20; }

}  // namespace

Runtime::Runtime(ChosenDevice device, Accuracy accuracy) try
    : device_(device),
      accuracy_(accuracy),
      context_(device_.info.handle),
      queue_(context_, device_.info.handle),
      side_queue_(context_, device_.info.handle) {
} catch (const cl::Error& error) {
  throw opencl_error(error, "opening the device", device.info.name);
}

cl::Kernel Runtime::kernel(const std::vector<std::string>& files, const std::string& name,
                           const Defines& defines) {
  const Recipe recipe = recipe_of(files, defines);
  const std::string options = option_text(recipe.defines, accuracy_);
  const std::string key = comma_separated(recipe.files) + " " + options;
  auto found = programs_.find(key);
  if (found == programs_.end())
    found = programs_.emplace(key, build(recipe.files, options, name)).first;
  return guarded(fmt::format("creating the kernel {}", name),
                 [&] { return cl::Kernel(found->second, name.c_str()); });
}

void Runtime::bundle(std::vector<std::string> files, Defines defines) {
  bundles_.push_back({std::move(files), std::move(defines)});
}

Runtime::Recipe Runtime::recipe_of(const std::vector<std::string>& files,
                                   const Defines& defines) const {
  const auto holds = [&](const Recipe& bundle) {
    return std::ranges::all_of(
               files, [&](const auto& f) { return std::ranges::count(bundle.files, f) > 0; }) &&
           std::ranges::includes(bundle.defines, defines);
  };
  const auto found = std::ranges::find_if(bundles_, holds);
  return found == bundles_.end() ? Recipe{files, defines} : *found;
}

cl::Program Runtime::build(const std::vector<std::string>& files, const std::string& options,
                           const std::string& kernel) {
  std::string source;
  for (const auto& file : files) source += kernel_sources().at(file);
  cl::Program program(context_, source);
  try {
    program.build({device_.info.handle}, options.c_str());
  } catch (const cl::Error& error) {
    throw device_error(
        fmt::format("the kernel {} of {} does not build for {} with {} ({}):\n{}", kernel,
                    comma_separated(files), device_.info.name, options,
                    opencl_error_name(error.err()), build_log(program, device_.info.handle)),
        "choose another device with --device, and report this log");
  }
  return program;
}

void Runtime::launch(const cl::Kernel& kernel, const cl::NDRange& global,
                     const cl::NDRange& local) {
  try {
    queue().enqueueNDRangeKernel(kernel, cl::NullRange, global, local);
  } catch (const cl::Error& error) {
    const auto name = kernel.getInfo<CL_KERNEL_FUNCTION_NAME>();
    throw opencl_error(error, fmt::format("the kernel {}", name), device_.info.name);
  }
}

void Runtime::chain(cl::CommandQueue& first, cl::CommandQueue& second) {
  guarded("joining two queues", [&] {
    std::vector<cl::Event> done(1);
    first.enqueueMarkerWithWaitList(nullptr, &done.front());
    first.flush();
    return second.enqueueBarrierWithWaitList(&done);
  });
}

void Runtime::fork() {
  if (!on_side_) chain(queue_, side_queue_);
}

void Runtime::join() {
  if (!on_side_) chain(side_queue_, queue_);
}

void Runtime::on_side(const std::function<void()>& launch_all) {
  const bool before = std::exchange(on_side_, true);
  try {
    launch_all();
  } catch (...) {
    on_side_ = before;
    throw;
  }
  on_side_ = before;
}

void Runtime::finish() {
  guarded("waiting for the kernels", [&] {
    side_queue_.finish();
    return queue_.finish();
  });
}

void Runtime::launch(const cl::Kernel& kernel, const cl::NDRange& global) {
  static const cl::NDRange ones[] = {cl::NDRange(1), cl::NDRange(1, 1), cl::NDRange(1, 1, 1)};
  launch(kernel, global,
         device_.info.type == "cpu" ? ones[global.dimensions() - 1] : cl::NullRange);
}

void Runtime::check_memory(std::size_t bytes) {
  const auto doing = fmt::format("allocating {} MiB, with {} MiB in use already and {} MiB in all,",
                                 mebibytes(bytes), mebibytes(*allocated_bytes_),
                                 mebibytes(device_.info.memory_bytes));
  // Some drivers promise more than there is, and the process is killed when it is written to.
  const auto used = std::min<std::uint64_t>(*allocated_bytes_, device_.info.memory_bytes);
  if (bytes > device_.info.memory_bytes - used)
    throw opencl_error(cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "the device's memory"), doing,
                       device_.info.name);
}

cl::Buffer Runtime::allocate_bytes(std::size_t bytes) {
  check_memory(bytes);
  return guarded(fmt::format("allocating {} MiB", mebibytes(bytes)), [&] {
    const std::size_t size = std::max<std::size_t>(bytes, 1);
    auto buffer = device_.info.type == "cpu" ? huge_page_buffer(context_, size)
                                             : cl::Buffer(context_, CL_MEM_READ_WRITE, size);
    count_until_released(buffer, bytes, allocated_bytes_);
    return buffer;
  });
}

}  // namespace touchtrace
