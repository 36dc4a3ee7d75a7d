#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/cl/device.h"

namespace touchtrace {

/// Values of the -D of a program, by name.
using Defines = std::map<std::string, std::string>;

/// `fast` flushes denormals; `exact` does not, and sums are compensated.
enum class Accuracy { fast, exact };

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

/// One device with its context, one in-order queue, and the programs built for it.
class Runtime {
 public:
  explicit Runtime(ChosenDevice device, Accuracy accuracy = Accuracy::fast);

  const DeviceInfo& device() const { return device_.info; }
  const std::string& reason() const { return device_.reason; }
  Accuracy accuracy() const { return accuracy_; }
  cl::CommandQueue& queue() { return queue_; }
  const cl::Context& context() const { return context_; }

  /// A kernel of the program made of `files` of kernels/, in that order. Programs are built once a
  /// runtime and set of defines. Throws device_error with device, options and log on a build failure.
  cl::Kernel kernel(const std::vector<std::string>& files, const std::string& name,
                    const Defines& defines = {});

  template <class T>
  Buffer<T> allocate(std::size_t size) {
    return {allocate_bytes(size * sizeof(T)), size};
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
    queue_.enqueueWriteBuffer(buffer.handle(), CL_TRUE, offset * sizeof(T), values.size_bytes(),
                              values.data());
  }
  template <class T>
  void read(const Buffer<T>& buffer, std::span<T> values, std::size_t offset = 0) {
    queue_.enqueueReadBuffer(buffer.handle(), CL_TRUE, offset * sizeof(T), values.size_bytes(),
                             values.data());
  }
  template <class T>
  std::vector<T> download(const Buffer<T>& buffer) {
    std::vector<T> values(buffer.size());
    read(buffer, std::span<T>(values));
    return values;
  }

  /// Queues a launch; returns at once.
  void launch(const cl::Kernel& kernel, const cl::NDRange& global, const cl::NDRange& local) {
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, global, local);
  }
  void finish() { queue_.finish(); }

 private:
  cl::Buffer allocate_bytes(std::size_t bytes);
  cl::Program build(const std::vector<std::string>& files, const std::string& options);

  ChosenDevice device_;
  Accuracy accuracy_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::map<std::string, cl::Program> programs_;
};

}  // namespace touchtrace
