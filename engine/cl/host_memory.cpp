#include "engine/cl/host_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <memory>

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

constexpr std::size_t huge_page = 2u << 20;
// Smaller buffers would waste most of a huge page.
constexpr std::size_t min_huge_page_bytes = 256u << 10;

/// Host memory aligned to a huge page, unmapped by the destructor.
class Pages {
 public:
  explicit Pages(std::size_t bytes) : size_(bytes + huge_page) {
    mapped_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped_ == MAP_FAILED) throw cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "mmap");
    madvise(mapped_, size_, MADV_HUGEPAGE);  // only advice: falls back to small pages
  }
  ~Pages() { munmap(mapped_, size_); }
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;

  void* data() const {
    const auto at = reinterpret_cast<std::uintptr_t>(mapped_);
    return reinterpret_cast<void*>(round_up(at, huge_page));
  }

 private:
  std::size_t size_;
  void* mapped_;
};

}  // namespace

cl::Buffer huge_page_buffer(const cl::Context& context, std::size_t bytes) {
  if (bytes < min_huge_page_bytes) return cl::Buffer(context, CL_MEM_READ_WRITE, bytes);
  auto pages = std::make_unique<Pages>(bytes);
  cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, pages->data());
  buffer.setDestructorCallback(
      [](cl_mem, void* owned) { const std::unique_ptr<Pages> freed(static_cast<Pages*>(owned)); },
      pages.get());
  pages.release();
  return buffer;
}

}  // namespace touchtrace
