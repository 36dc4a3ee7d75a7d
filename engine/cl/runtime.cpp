#include "engine/cl/runtime.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "engine/base/provenance.h"
#include "engine/base/text.h"
#include "engine/cl/host_memory.h"

namespace touchtrace {
namespace {

// A driver that takes longer did not find the program in its cache, and no kernels then.
constexpr double longest_cached_build_s = 0.3;

const char* options_for(Accuracy accuracy) {
  return accuracy == Accuracy::fast ? "-cl-std=CL1.2 -cl-kernel-arg-info -cl-denorms-are-zero"
                                    : "-cl-std=CL1.2 -cl-kernel-arg-info -D EXACT=1";
}

/// "the kernels gemm, pack of common.clh, dense.cl with -D WIDTH=2"
std::string described(const ProgramPart& part, const std::vector<std::string>& kernels) {
  std::string text = fmt::format("the kernel{} {} of {}", kernels.size() > 1 ? "s" : "",
                                 comma_separated(kernels), comma_separated(part.files));
  for (const auto& [name, value] : part.defines) text += fmt::format(" -D {}={}", name, value);
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

Runtime::Runtime(ChosenDevice device, Accuracy accuracy, std::optional<Body> body) try
    : device_(device),
      accuracy_(accuracy),
      body_(body.value_or(body_for(device.info))),
      context_(device_.info.handle),
      queue_(context_, device_.info.handle),
      side_queue_(context_, device_.info.handle) {
} catch (const cl::Error& error) {
  throw opencl_error(error, "opening the device", device.info.name);
}

Kernel Runtime::kernel(const std::vector<std::string>& files, const std::string& name,
                       const Defines& defines) {
  const auto same = [&](const Part& part) {
    return part.text.files == files && part.text.defines == defines;
  };
  auto part = std::ranges::find_if(parts_, same);
  if (part == parts_.end()) part = parts_.insert(parts_.end(), Part{{files, defines}, {}, {}});
  if (std::ranges::count(part->kernels, name) == 0) part->kernels.push_back(name);
  return {name, static_cast<int>(part - parts_.begin())};
}

cl::Kernel Runtime::create(const Kernel& kernel) {
  const auto& part = parts_.at(static_cast<std::size_t>(kernel.part));
  if (!part.program()) build_parts();
  return guarded(fmt::format("creating the kernel {}", kernel.name), [&] {
    return cl::Kernel(part.program, name_in_program(kernel.name, part.number).c_str());
  });
}

void Runtime::build_parts() {
  std::vector<Part*> parts;
  for (auto& part : parts_)
    if (!part.program()) part.number = static_cast<int>(parts.size()), parts.push_back(&part);
  const Stopwatch stopwatch;
  const auto program = build(parts);
  for (auto* part : parts) part->program = program;
  if (device_.info.is_pocl && stopwatch.wall_seconds() > longest_cached_build_s)
    compile_beside(program, parts);
}

void Runtime::compile_beside(const cl::Program& program, const std::vector<Part*>& parts) {
  CompilerTask task{
      device_.info.number, options_for(accuracy_), program.getInfo<CL_PROGRAM_SOURCE>(), {}};
  for (const auto* part : parts)
    for (const auto& kernel : part->kernels)
      task.kernels.push_back(name_in_program(kernel, part->number));
  compiler_ = start_compiler(task);
}

cl::Program Runtime::build(const std::vector<Part*>& parts) {
  std::vector<ProgramPart> texts;
  for (const auto* part : parts) texts.push_back(part->text);
  cl::Program program(context_, joined_source(texts));
  try {
    program.build({device_.info.handle}, options_for(accuracy_));
  } catch (const cl::Error& error) {
    if (parts.size() > 1)  // finds the one to blame
      for (auto* part : parts) build({part});
    throw build_error(error, program, parts);
  }
  return program;
}

Error Runtime::build_error(const cl::Error& error, const cl::Program& program,
                           const std::vector<Part*>& parts) const {
  std::vector<std::string> kernels;
  for (const auto* part : parts) kernels.push_back(described(part->text, part->kernels));
  return device_error(
      fmt::format("{} cannot be built for {} with {} ({}):\n{}", comma_separated(kernels),
                  device_.info.name, options_for(accuracy_), opencl_error_name(error.err()),
                  build_log(program, device_.info.handle)),
      "choose another device with --device, and report this log");
}

void Runtime::launch(const cl::Kernel& kernel, const cl::NDRange& global,
                     const cl::NDRange& local) {
  try {
    queue().enqueueNDRangeKernel(kernel, cl::NullRange, global, local);
  } catch (const cl::Error& error) {
    const auto name = name_in_part(kernel.getInfo<CL_KERNEL_FUNCTION_NAME>());
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
