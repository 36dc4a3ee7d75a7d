#pragma once

#include <filesystem>

namespace touchtrace {

/// A new folder among the system's temporary files, gone with its contents at the end.
class ScratchFolder {
 public:
  /// Throws failure if there is no room for it.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace touchtrace
