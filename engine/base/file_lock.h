#pragma once

#include <filesystem>

namespace touchtrace {

/// Exclusive lock of an output, held by the file OUTPUT.lock and released by the kernel when the
/// process ends, however it ends.
class FileLock {
 public:
  /// Throws usage_error if another process, or another lock of this one, holds it; failure if the
  /// file cannot be created.
  explicit FileLock(const std::filesystem::path& output);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace touchtrace
