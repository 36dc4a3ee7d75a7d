#include "engine/base/file_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

/// Whether `path` still names the open file: the holder before may have removed it.
bool is_current(int descriptor, const std::filesystem::path& path) {
  struct stat open {
  }, named{};
  return fstat(descriptor, &open) == 0 && stat(path.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

int open_lock(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0)
    throw failure(fmt::format("cannot create {}: {}", path.string(), std::strerror(errno)),
                  "check the folder's permissions");
  return descriptor;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& output) : path_(output.string() + ".lock") {
  if (output.has_parent_path()) std::filesystem::create_directories(output.parent_path());
  for (;;) {
    descriptor_ = open_lock(path_);
    const bool locked = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    if (locked && is_current(descriptor_, path_)) return;
    close(descriptor_);
    if (!locked)
      throw usage_error(fmt::format("another process is writing {}", output.string()),
                        "wait for it, stop it, or choose another --output");
  }
}

FileLock::~FileLock() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  close(descriptor_);
}

}  // namespace touchtrace
