#include "engine/cl/runtime.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "engine/base/integer_math.h"
#include "engine/base/provenance.h"
#include "engine/base/text.h"
#include "engine/cl/host_memory.h"

namespace touchtrace {
namespace {

// A build that takes longer did not find the program, and so no kernels, in the driver's cache.
constexpr double max_cached_build_s = 0.3;

const char* options_for(Accuracy accuracy) {
  return accuracy == Accuracy::fast ? "-cl-std=CL1.2 -cl-kernel-arg-info -cl-denorms-are-zero"
                                    : "-cl-std=CL1.2 -cl-kernel-arg-info -D EXACT=1";
}

/// "the kernels gemm, pack of common.clh, dense.cl -D WIDTH=2"
std::string description(const ProgramModule& module, const std::vector<std::string>& kernels) {
  std::string text = fmt::format("the kernel{} {} of {}", kernels.size() > 1 ? "s" : "",
                                 comma_separated(kernels), comma_separated(module.files));
  for (const auto& [name, value] : module.defines) text += fmt::format(" -D {}={}", name, value);
  return text;
}

std::string build_log(const cl::Program& program, const cl::Device& device) {
  try {
    return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
  } catch (const cl::Error&) {
    return "(no build log)";
  }
}

using ByteCount = std::shared_ptr<std::atomic<std::size_t>>;

/// Adds `bytes` to `count` until the buffer is released.
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

/// MiB, rounded up.
std::uint64_t mebibytes(std::uint64_t bytes) { return ceil_div<std::uint64_t>(bytes, 1u << 20); }

}  // namespace

Runtime::Runtime(ChosenDevice device, Accuracy accuracy, std::optional<KernelVariant> variant) try
    : device_(device),
      accuracy_(accuracy),
      kernel_variant_(variant.value_or(default_variant(device.info))),
      context_(device_.info.handle),
      queue_(context_, device_.info.handle),
      side_queue_(context_, device_.info.handle) {
} catch (const cl::Error& error) {
  throw opencl_error(error, "opening the device", device.info.name);
}

Kernel Runtime::kernel(const std::vector<std::string>& files, const std::string& name,
                       const Defines& defines) {
  const auto is_same = [&](const Module& module) {
    return module.text.files == files && module.text.defines == defines;
  };
  auto module = std::ranges::find_if(modules_, is_same);
  if (module == modules_.end())
    module = modules_.insert(modules_.end(), Module{{files, defines}, {}, {}, 0, {}});
  if (std::ranges::count(module->kernels, name) == 0) module->kernels.push_back(name);
  return {name, static_cast<int>(module - modules_.begin())};
}

cl::Kernel Runtime::create(const Kernel& kernel) {
  const auto& module = modules_.at(static_cast<std::size_t>(kernel.module));
  if (!module.program() && !module.build_error) build_pending();
  if (module.build_error) throw *module.build_error;
  return guarded(fmt::format("creating the kernel {}", kernel.name), [&] {
    return cl::Kernel(module.program, mangled_kernel_name(kernel.name, module.number).c_str());
  });
}

void Runtime::build_pending() {
  std::vector<Module*> pending;
  for (auto& module : modules_)
    if (!module.program() && !module.build_error) pending.push_back(&module);
  const Stopwatch stopwatch;
  cl::Program program;
  try {
    program = build(pending);
  } catch (const Error&) {
    for (auto* module : pending) build_alone(*module);
    return;
  }
  for (int number = 0; auto* module : pending) module->program = program, module->number = number++;
  if (device_.info.is_pocl && stopwatch.wall_seconds() > max_cached_build_s)
    compile_in_background(program, pending);
}

void Runtime::build_alone(Module& module) {
  try {
    module.program = build({&module});
    module.number = 0;
  } catch (const Error& error) {
    module.build_error = error;
  }
}

void Runtime::compile_in_background(const cl::Program& program,
                                    const std::vector<Module*>& modules) {
  CompilerTask task{
      device_.info.number, options_for(accuracy_), program.getInfo<CL_PROGRAM_SOURCE>(), {}};
  for (const auto* module : modules)
    for (const auto& kernel : module->kernels)
      task.kernels.push_back(mangled_kernel_name(kernel, module->number));
  compiler_ = start_compiler(task);
}

cl::Program Runtime::build(const std::vector<Module*>& modules) {
  std::vector<ProgramModule> texts;
  for (const auto* module : modules) texts.push_back(module->text);
  cl::Program program(context_, combined_source(texts));
  try {
    program.build({device_.info.handle}, options_for(accuracy_));
  } catch (const cl::Error& error) {
    throw build_error(error, program, modules);
  }
  return program;
}

Error Runtime::build_error(const cl::Error& error, const cl::Program& program,
                           const std::vector<Module*>& modules) const {
  std::vector<std::string> kernels;
  for (const auto* module : modules) kernels.push_back(description(module->text, module->kernels));
  return device_error(
      fmt::format("{} cannot be built for {} with {} ({}):\n{}", comma_separated(kernels),
                  device_.info.name, options_for(accuracy_), opencl_error_name(error.err()),
                  build_log(program, device_.info.handle)),
      "choose another device with --device and report this log");
}

void Runtime::launch(const cl::Kernel& kernel, const cl::NDRange& global,
                     const cl::NDRange& local) {
  try {
    queue().enqueueNDRangeKernel(kernel, cl::NullRange, global, local);
  } catch (const cl::Error& error) {
    const auto name = unmangled_kernel_name(kernel.getInfo<CL_KERNEL_FUNCTION_NAME>());
    throw opencl_error(error, fmt::format("the kernel {}", name), device_.info.name);
  }
}

void Runtime::chain(cl::CommandQueue& first, cl::CommandQueue& second) {
  guarded("synchronising two queues", [&] {
    std::vector<cl::Event> done(1);
    first.enqueueMarkerWithWaitList(nullptr, &done.front());
    first.flush();
    return second.enqueueBarrierWithWaitList(&done);
  });
}

void Runtime::fork() {
  if (!on_side_queue_) chain(queue_, side_queue_);
}

void Runtime::join() {
  if (!on_side_queue_) chain(side_queue_, queue_);
}

void Runtime::on_side_queue(const std::function<void()>& enqueue_all) {
  const bool before = std::exchange(on_side_queue_, true);
  try {
    enqueue_all();
  } catch (...) {
    on_side_queue_ = before;
    throw;
  }
  on_side_queue_ = before;
}

Runtime::~Runtime() {
  for (const auto& queue : {side_queue_, queue_})
    if (queue()) clFinish(queue());  // a destructor cannot report its error
}

void Runtime::finish() {
  guarded("waiting for kernels", [&] {
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
  const auto action =
      fmt::format("allocating {} MiB, with {} of {} MiB in use,", mebibytes(bytes),
                  mebibytes(*allocated_bytes_), mebibytes(device_.info.memory_bytes));
  // PoCL allocates more than there is; the process is then killed on the first write. Other drivers
  // fail, and may release buffers late.
  const auto used = device_.info.type == "cpu"
                        ? std::min<std::uint64_t>(*allocated_bytes_, device_.info.memory_bytes)
                        : 0;
  if (bytes > device_.info.memory_bytes - used)
    throw opencl_error(cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "the device's memory"), action,
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
