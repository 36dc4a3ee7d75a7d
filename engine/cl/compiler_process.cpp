#include "engine/cl/compiler_process.h"

#include <sys/prctl.h>

#include <csignal>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ranges>

#include "engine/cl/device.h"

namespace touchtrace {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CompilerTask, device, options, source, kernels)

namespace {

std::vector<std::string>& registered_arguments() {
  static std::vector<std::string> arguments;
  return arguments;
}

/// Zero-valued kernel arguments, with which a kernel does next to nothing. Needed because PoCL
/// rejects launches without work-items.
class DummyArguments {
 public:
  DummyArguments(const cl::Context& context, cl::CommandQueue& queue)
      : input_(zeros(context, queue)), output_(zeros(context, queue)) {}

  void bind(cl::Kernel& kernel) const {
    const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
    for (cl_uint i = 0; i < count; ++i)
      if (kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(i) == CL_KERNEL_ARG_ADDRESS_PRIVATE)
        bind_number(kernel, i);
      else
        kernel.setArg(i, is_input(kernel, i) ? input_ : output_);
  }

 private:
  static constexpr std::size_t bytes = 16u << 20;  // more than one work-item accesses

  /// Upper half of a zeroed buffer, since kernels may access elements before their argument.
  static cl::Buffer zeros(const cl::Context& context, cl::CommandQueue& queue) {
    cl::Buffer whole(context, CL_MEM_READ_WRITE, bytes);
    queue.enqueueFillBuffer(whole, cl_float{0}, 0, bytes);
    const cl_buffer_region upper_half{bytes / 2, bytes / 2};
    return whole.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &upper_half);
  }
  static bool is_input(const cl::Kernel& kernel, cl_uint i) {
    return kernel.getArgInfo<CL_KERNEL_ARG_TYPE_QUALIFIER>(i) & CL_KERNEL_ARG_TYPE_CONST;
  }
  /// OpenCL cannot query the size of a by-value argument, so all possible sizes are tried.
  static void bind_number(cl::Kernel& kernel, cl_uint i) {
    constexpr char zero[64] = {};
    for (const std::size_t size : {4, 8, 16, 32, 64})
      if (clSetKernelArg(kernel(), i, size, zero) == CL_SUCCESS) return;
  }

  cl::Buffer input_, output_;
};

}  // namespace

void register_compiler_arguments(std::vector<std::string> arguments) {
  registered_arguments() = std::move(arguments);
}

std::unique_ptr<BackgroundProcess> start_compiler(const CompilerTask& task) {
  if (registered_arguments().empty()) return nullptr;
  return std::make_unique<BackgroundProcess>(registered_arguments(), nlohmann::json(task).dump());
}

void compile_from_stdin() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // useless without the parent process
  const std::string text(std::istreambuf_iterator<char>(std::cin), {});
  compile_kernels(nlohmann::json::parse(text).get<CompilerTask>());
}

void compile_kernels(const CompilerTask& task) {
  const auto device = list_devices().at(static_cast<std::size_t>(task.device)).handle;
  const cl::Context context(device);
  cl::CommandQueue queue(context, device);
  cl::Program program(context, task.source);
  program.build({device}, task.options.c_str());
  const DummyArguments arguments(context, queue);
  for (const auto& name : task.kernels | std::views::reverse) {
    cl::Kernel kernel(program, name.c_str());
    arguments.bind(kernel);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.finish();
  }
}

}  // namespace touchtrace
