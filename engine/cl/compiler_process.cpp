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

std::vector<std::string>& offered_arguments() {
  static std::vector<std::string> arguments;
  return arguments;
}

/// Arguments that make a kernel do nothing, or next to nothing: numbers are zero and so are the
/// arrays that it reads. PoCL refuses to launch no work-items at all.
class NothingToDo {
 public:
  explicit NothingToDo(const cl::Context& context, cl::CommandQueue& queue)
      : read_(zeros(context, queue)), written_(zeros(context, queue)) {}

  void give_to(cl::Kernel& kernel) const {
    const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
    for (cl_uint i = 0; i < count; ++i)
      if (kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(i) == CL_KERNEL_ARG_ADDRESS_PRIVATE)
        give_number(kernel, i);
      else
        kernel.setArg(i, is_read(kernel, i) ? read_ : written_);
  }

 private:
  static constexpr std::size_t bytes = 16u << 20;  // more than a work-item reaches

  /// From its middle on, since kernels may look back.
  static cl::Buffer zeros(const cl::Context& context, cl::CommandQueue& queue) {
    cl::Buffer whole(context, CL_MEM_READ_WRITE, bytes);
    queue.enqueueFillBuffer(whole, cl_float{0}, 0, bytes);
    const cl_buffer_region middle{bytes / 2, bytes / 2};
    return whole.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &middle);
  }
  static bool is_read(const cl::Kernel& kernel, cl_uint i) {
    return kernel.getArgInfo<CL_KERNEL_ARG_TYPE_QUALIFIER>(i) & CL_KERNEL_ARG_TYPE_CONST;
  }
  /// The kernel knows its size, but has no way to say it.
  static void give_number(cl::Kernel& kernel, cl_uint i) {
    constexpr char zero[64] = {};
    for (const std::size_t size : {4, 8, 16, 32, 64})
      if (clSetKernelArg(kernel(), i, size, zero) == CL_SUCCESS) return;
  }

  cl::Buffer read_, written_;
};

}  // namespace

void offer_compiler_process(std::vector<std::string> arguments) {
  offered_arguments() = std::move(arguments);
}

std::unique_ptr<BackgroundProcess> start_compiler(const CompilerTask& task) {
  if (offered_arguments().empty()) return nullptr;
  return std::make_unique<BackgroundProcess>(offered_arguments(), nlohmann::json(task).dump());
}

void compile_from_stdin() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // of no use without the process that asked
  const std::string text(std::istreambuf_iterator<char>(std::cin), {});
  compile_kernels(nlohmann::json::parse(text).get<CompilerTask>());
}

void compile_kernels(const CompilerTask& task) {
  const auto device = list_devices().at(static_cast<std::size_t>(task.device)).handle;
  const cl::Context context(device);
  cl::CommandQueue queue(context, device);
  cl::Program program(context, task.source);
  program.build({device}, task.options.c_str());
  const NothingToDo nothing(context, queue);
  for (const auto& name : task.kernels | std::views::reverse) {
    cl::Kernel kernel(program, name.c_str());
    nothing.give_to(kernel);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.finish();
  }
}

}  // namespace touchtrace
