#pragma once

#include <filesystem>

namespace touchtrace {

/// New folder in the system's temporary directory; the destructor removes it with its contents.
class ScratchFolder {
 public:
  /// Throws failure if it cannot be created.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace touchtrace
