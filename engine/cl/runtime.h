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

#include "engine/cl/body.h"
#include "engine/cl/compiler_process.h"
#include "engine/cl/device.h"
#include "engine/cl/opencl_error.h"
#include "engine/cl/program_source.h"

namespace touchtrace {

/// `fast` flushes denormals; `exact` does not, and long sums are compensated.
enum class Accuracy { fast, exact };
/// Of "fast" or "exact".
inline Accuracy accuracy_of(std::string_view name) {
  return name == "exact" ? Accuracy::exact : Accuracy::fast;
}

/// An array of `T` in device memory.
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

/// A kernel that a Runtime was asked for; create() makes it.
struct Kernel {
  std::string name;
  int part;  ///< of those that the runtime was asked for
};

class Launch;
/// Called with each Launch right after it was queued.
using LaunchWatcher = std::function<void(const Launch&)>;

/// One device with its context, its queues, and the programs built for it. Everything goes to one
/// in-order queue, except between fork() and join().
class Runtime {
 public:
  /// `body`: empty for the device's own; tests run each on every device.
  explicit Runtime(ChosenDevice device, Accuracy accuracy = Accuracy::fast,
                   std::optional<Body> body = {});

  const DeviceInfo& device() const { return device_.info; }
  const std::string& reason() const { return device_.reason; }
  Accuracy accuracy() const { return accuracy_; }
  Body body() const { return body_; }
  /// The one that launches go to now.
  cl::CommandQueue& queue() { return on_side_ ? side_queue_ : queue_; }
  const cl::Context& context() const { return context_; }

  /// A kernel of `files` of kernels/, in that order. It is built when create() first needs it,
  /// together with everything asked for until then.
  Kernel kernel(const std::vector<std::string>& files, const std::string& name,
                const Defines& defines = {});
  /// Without arguments. Throws device_error with device, options, log and the kernels' names on a
  /// build failure.
  cl::Kernel create(const Kernel& kernel);

  /// Throws device_error if the device has not this much memory left: asked before many buffers are
  /// made, so that a model that is far too large fails at once.
  void check_memory(std::size_t bytes);
  /// Of parts of a buffer [bytes], enough for every device that we know.
  static constexpr std::size_t part_alignment = 512;
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
  /// `size` elements of a buffer from `at` on, shared. Throws device_error unless `at` is a
  /// multiple of `part_alignment` bytes.
  template <class T>
  Buffer<T> part_of(const Buffer<T>& whole, std::size_t at, std::size_t size) {
    const cl_buffer_region region{at * sizeof(T), size * sizeof(T)};
    auto handle = whole.handle();
    return {guarded("sharing a part of a buffer",
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
  /// Blocks until the values may be reused.
  template <class T>
  void write(const Buffer<T>& buffer, std::span<const T> values, std::size_t offset = 0) {
    if (values.empty()) return;
    guarded("writing to the device", [&] {
      return queue().enqueueWriteBuffer(buffer.handle(), CL_TRUE, offset * sizeof(T),
                                        values.size_bytes(), values.data());
    });
  }
  /// Only queues the writing: the values must last until the queue has come past it.
  template <class T>
  void queue_write(const Buffer<T>& buffer, std::span<const std::type_identity_t<T>> values,
                   std::size_t offset = 0) {
    guarded("writing to the device", [&] {
      return queue().enqueueWriteBuffer(buffer.handle(), CL_FALSE, offset * sizeof(T),
                                        values.size_bytes(), values.data());
    });
  }
  /// Queues `size` elements from `from` on to go to `to`; the two must not overlap.
  template <class T>
  void queue_copy(const Buffer<T>& buffer, std::size_t from, std::size_t to, std::size_t size) {
    if (size == 0) return;
    guarded("copying on the device", [&] {
      return queue().enqueueCopyBuffer(buffer.handle(), buffer.handle(), from * sizeof(T),
                                       to * sizeof(T), size * sizeof(T));
    });
  }
  /// Only queues the reading: the values are there once the queue has come past it.
  template <class T>
  void queue_read(const Buffer<T>& buffer, std::span<std::type_identity_t<T>> values,
                  std::size_t offset = 0) {
    guarded("reading from the device", [&] {
      return queue().enqueueReadBuffer(buffer.handle(), CL_FALSE, offset * sizeof(T),
                                       values.size_bytes(), values.data());
    });
  }
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

  /// Queues a launch; returns at once. Throws device_error if the device refuses it.
  void launch(const cl::Kernel& kernel, const cl::NDRange& global, const cl::NDRange& local);
  /// Queues a kernel without barriers: in work-groups of one work-item on a CPU, where a work-item
  /// is a tile, and of the driver's choice elsewhere.
  void launch(const cl::Kernel& kernel, const cl::NDRange& global);
  /// Between fork() and join() a second queue runs beside the first one, so that a device with
  /// several cores need not wait where a launch ends: it gets what on_side() launches. It waits for
  /// what was queued before fork(); what is queued after join() waits for it. Inside on_side() all
  /// of this changes nothing.
  void fork();
  void join();
  void on_side(const std::function<void()>& launch_all);

  /// Waits until everything queued is done.
  void finish();

  /// From now on `watcher` sees every launch; an empty one ends that.
  void watch(LaunchWatcher watcher) { watcher_ = std::move(watcher); }
  const LaunchWatcher& watcher() const { return watcher_; }

 private:
  /// The result of an OpenCL call; its errors become device_errors that say what was being done.
  template <class Call>
  auto guarded(std::string_view doing, Call call) {
    try {
      return call();
    } catch (const cl::Error& error) {
      throw opencl_error(error, doing, device_.info.name);
    }
  }
  cl::Buffer allocate_bytes(std::size_t bytes);
  /// What `second` gets from now on waits for what `first` holds.
  void chain(cl::CommandQueue& first, cl::CommandQueue& second);
  /// What kernels were asked of.
  struct Part {
    ProgramPart text;
    std::vector<std::string> kernels;
    cl::Program program;  ///< null until it is built
    int number = 0;       ///< in its program
  };

  void build_parts();
  cl::Program build(const std::vector<Part*>& parts);
  void compile_beside(const cl::Program& program, const std::vector<Part*>& parts);
  Error build_error(const cl::Error& error, const cl::Program& program,
                    const std::vector<Part*>& parts) const;

  ChosenDevice device_;
  Accuracy accuracy_;
  Body body_;
  cl::Context context_;
  cl::CommandQueue queue_, side_queue_;
  bool on_side_ = false;
  /// In use now; shared with the buffers, which may live longer than the runtime.
  std::shared_ptr<std::atomic<std::size_t>> allocated_bytes_ =
      std::make_shared<std::atomic<std::size_t>>(0);
  std::vector<Part> parts_;
  std::unique_ptr<BackgroundProcess> compiler_;  ///< null unless kernels were built anew
  LaunchWatcher watcher_;
};

}  // namespace touchtrace
