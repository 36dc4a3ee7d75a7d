#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace touchtrace {

/// Writes a zip archive without compression, as numpy.savez does (APPNOTE.TXT of PKWARE). All files
/// have the date 1 January 1980, so that equal contents give equal bytes.
class ZipWriter {
 public:
  explicit ZipWriter(const std::filesystem::path& path);

  /// Throws data_error if the archive would exceed 4 GiB.
  void add(const std::string& name, const std::string& content);
  /// Writes the directory. Throws failure if the disk is full.
  void finish();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
  std::string directory_;
  std::uint64_t size_ = 0;
  std::uint16_t files_ = 0;
};

}  // namespace touchtrace
