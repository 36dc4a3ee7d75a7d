#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/cl/compiler_process.h"
#include "engine/cl/device.h"
#include "engine/cl/kernel_variant.h"
#include "engine/cl/opencl_error.h"
#include "engine/cl/program_source.h"

namespace touchtrace {

/// Numerical mode of the kernels.
/// `fast`: denormals are flushed to zero; sums are plain.
/// `exact`: denormals are kept; convolutions never use Winograd's method; long sums are compensated
/// (Kahan): those of matrix products, convolutions and their gradients, roll-outs, LayerNorm, the
/// optimiser (which also accumulates steps below a parameter's last place) and the loss. Not
/// compensated: sums of a fixed number of terms (16, on GPUs up to 256), and adding the partial
/// sums of micro-batches.
enum class Accuracy { fast, exact };
/// Parses "fast" or "exact".
inline Accuracy accuracy_of(std::string_view name) {
  return name == "exact" ? Accuracy::exact : Accuracy::fast;
}

/// Array of `T` in device memory.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(cl::Buffer handle, std::size_t size) : handle_(std::move(handle)), size_(size) {}

  std::size_t size() const { return size_; }
  const cl::Buffer& handle() const { return handle_; }

 private:
  cl::Buffer handle_;
  std::size_t size_ = 0;
};

/// Handle of a kernel registered with Runtime::kernel().
struct Kernel {
  std::string name;
  int module;  ///< index of its program module in the Runtime
};

class Launch;
/// Called with each Launch after it has been enqueued.
using LaunchObserver = std::function<void(const Launch&)>;

/// OpenCL device with context, command queues and the programs built for it. Commands go to one
/// in-order queue, except between fork() and join(). Errors of OpenCL calls are thrown as
/// device_error. Not thread-safe.
class Runtime {
 public:
  /// `variant`: default_variant() of the device if empty.
  explicit Runtime(ChosenDevice device, Accuracy accuracy = Accuracy::fast,
                   std::optional<KernelVariant> variant = {});
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;
  /// Waits for commands that are still queued: PoCL crashes if the program ends while it compiles
  /// one.
  ~Runtime();

  const DeviceInfo& device() const { return device_.info; }
  const std::string& reason() const { return device_.reason; }
  Accuracy accuracy() const { return accuracy_; }
  KernelVariant kernel_variant() const { return kernel_variant_; }
  /// Queue that commands currently go to.
  cl::CommandQueue& queue() { return on_side_queue_ ? side_queue_ : queue_; }
  const cl::Context& context() const { return context_; }

  /// Registers a kernel of `files` of kernels/, concatenated in this order. It is built by the
  /// first create() that needs it, together with all kernels registered until then.
  Kernel kernel(const std::vector<std::string>& files, const std::string& name,
                const Defines& defines = {});
  /// Creates a kernel without arguments. Throws device_error with device, options, build log and
  /// kernel names if its module does not build; other modules remain usable.
  cl::Kernel create(const Kernel& kernel);

  /// Throws device_error if less than this much device memory is left, or on other devices than
  /// CPUs if the device has less: their drivers report what is left when they allocate. Called
  /// before many allocations, so that a model that is too large fails at once.
  void check_memory(std::size_t bytes);
  /// Alignment of sub-buffers [bytes], sufficient for all known devices.
  static constexpr std::size_t sub_buffer_alignment = 512;
  template <class T>
  Buffer<T> allocate(std::size_t size) {
    return {allocate_bytes(size * sizeof(T)), size};
  }
  template <class T>
  Buffer<T> allocate_zeros(std::size_t size) {
    auto buffer = allocate<T>(size);
    fill(buffer, T{});
    return buffer;
  }
  /// Elements `offset` .. `offset` + `size` - 1 of a buffer, sharing its memory. Throws
  /// device_error unless the offset is a multiple of sub_buffer_alignment bytes.
  template <class T>
  Buffer<T> sub_buffer(const Buffer<T>& whole, std::size_t offset, std::size_t size) {
    const cl_buffer_region region{offset * sizeof(T), size * sizeof(T)};
    auto handle = whole.handle();
    return {guarded("creating a sub-buffer",
                    [&] {
                      return handle.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION,
                                                    &region);
                    }),
            size};
  }
  template <class T>
  void fill(const Buffer<T>& buffer, T value) {
    if (buffer.size() == 0) return;
    guarded("filling a buffer", [&] {
      return queue().enqueueFillBuffer(buffer.handle(), value, 0, buffer.size() * sizeof(T));
    });
  }
  template <class T>
  Buffer<T> upload(std::span<const T> values) {
    auto buffer = allocate<T>(values.size());
    write(buffer, values);
    return buffer;
  }
  /// Writes and waits.
  template <class T>
  void write(const Buffer<T>& buffer, std::span<const T> values, std::size_t offset = 0) {
    if (values.empty()) return;
    guarded("writing to the device", [&] {
      return queue().enqueueWriteBuffer(buffer.handle(), CL_TRUE, offset * sizeof(T),
                                        values.size_bytes(), values.data());
    });
  }
  /// Writes without waiting: `values` must stay valid until the command has completed.
  template <class T>
  void enqueue_write(const Buffer<T>& buffer, std::span<const std::type_identity_t<T>> values,
                     std::size_t offset = 0) {
    guarded("writing to the device", [&] {
      return queue().enqueueWriteBuffer(buffer.handle(), CL_FALSE, offset * sizeof(T),
                                        values.size_bytes(), values.data());
    });
  }
  /// Reads and waits.
  template <class T>
  void read(const Buffer<T>& buffer, std::span<T> values, std::size_t offset = 0) {
    if (values.empty()) return;
    guarded("reading from the device", [&] {
      return queue().enqueueReadBuffer(buffer.handle(), CL_TRUE, offset * sizeof(T),
                                       values.size_bytes(), values.data());
    });
  }
  template <class T>
  std::vector<T> download(const Buffer<T>& buffer) {
    std::vector<T> values(buffer.size());
    read(buffer, std::span<T>(values));
    return values;
  }

  /// Enqueues a kernel without waiting.
  void launch(const cl::Kernel& kernel, const cl::NDRange& global, const cl::NDRange& local);
  /// Enqueues a kernel without barriers: with local size 1 on a CPU, where a work-item computes a
  /// tile, and with the driver's choice elsewhere.
  void launch(const cl::Kernel& kernel, const cl::NDRange& global);

  /// Between fork() and join() a second queue runs concurrently with the first, so that cores are
  /// not idle at the end of each launch. It gets the commands enqueued inside on_side_queue(),
  /// waits for commands enqueued before fork(), and commands enqueued after join() wait for it.
  /// Inside on_side_queue(), fork() and join() do nothing.
  void fork();
  void join();
  void on_side_queue(const std::function<void()>& enqueue_all);

  /// Waits until both queues are empty.
  void finish();

  /// Calls `observer` after every Launch from now on; empty: none.
  void set_launch_observer(LaunchObserver observer) { observer_ = std::move(observer); }
  const LaunchObserver& launch_observer() const { return observer_; }

 private:
  /// Result of an OpenCL call; its errors become device_errors that name the action.
  template <class Call>
  auto guarded(std::string_view action, Call call) {
    try {
      return call();
    } catch (const cl::Error& error) {
      throw opencl_error(error, action, device_.info.name);
    }
  }
  cl::Buffer allocate_bytes(std::size_t bytes);
  /// Makes later commands of `second` wait for the present commands of `first`.
  void chain(cl::CommandQueue& first, cl::CommandQueue& second);

  struct Module {
    ProgramModule text;
    std::vector<std::string> kernels;  ///< registered ones
    cl::Program program;               ///< null until it is built
    int number = 0;                    ///< within the program
    std::optional<Error> build_error;  ///< set if the build failed; not tried again
  };

  /// Builds all registered modules that are neither built nor failed.
  void build_pending();
  cl::Program build(const std::vector<Module*>& modules);
  /// Builds one module; stores the error if that fails.
  void build_alone(Module& module);
  void compile_in_background(const cl::Program& program, const std::vector<Module*>& modules);
  Error build_error(const cl::Error& error, const cl::Program& program,
                    const std::vector<Module*>& modules) const;

  ChosenDevice device_;
  Accuracy accuracy_;
  KernelVariant kernel_variant_;
  cl::Context context_;
  cl::CommandQueue queue_, side_queue_;
  bool on_side_queue_ = false;
  /// Bytes in use; shared with the buffers, which may outlive the runtime.
  std::shared_ptr<std::atomic<std::size_t>> allocated_bytes_ =
      std::make_shared<std::atomic<std::size_t>>(0);
  std::vector<Module> modules_;
  std::unique_ptr<BackgroundProcess> compiler_;  ///< null unless kernels had to be compiled
  LaunchObserver observer_;
};

}  // namespace touchtrace
