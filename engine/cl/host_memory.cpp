#include "engine/cl/host_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <memory>

namespace touchtrace {
namespace {

constexpr std::size_t huge_page = 2u << 20;
// Below this a whole page would be too much to waste.
constexpr std::size_t smallest = 256u << 10;

/// Pages of the host that begin at a huge page, given back at the end.
class Pages {
 public:
  explicit Pages(std::size_t bytes) : size_(bytes + huge_page) {
    mapped_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped_ == MAP_FAILED) throw cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "mmap");
    madvise(mapped_, size_, MADV_HUGEPAGE);  // a wish: where it is not granted, pages are small
  }
  ~Pages() { munmap(mapped_, size_); }
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;

  void* data() const {
    const auto at = reinterpret_cast<std::uintptr_t>(mapped_);
    return reinterpret_cast<void*>((at + huge_page - 1) / huge_page * huge_page);
  }

 private:
  std::size_t size_;
  void* mapped_;
};

}  // namespace

cl::Buffer huge_page_buffer(const cl::Context& context, std::size_t bytes) {
  if (bytes < smallest) return cl::Buffer(context, CL_MEM_READ_WRITE, bytes);
  auto pages = std::make_unique<Pages>(bytes);
  cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, pages->data());
  buffer.setDestructorCallback(
      [](cl_mem, void* owned) { const std::unique_ptr<Pages> freed(static_cast<Pages*>(owned)); },
      pages.get());
  pages.release();
  return buffer;
}

}  // namespace touchtrace
