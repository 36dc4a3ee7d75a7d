#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchtrace {

/// An output file that appears whole or not at all.
///
/// The constructor refuses a path that exists unless `overwrite`; the caller writes `temporary()`,
/// in the same folder, and `commit()` does fsync, rename, fsync of the folder. Without a commit the
/// destructor removes the temporary file, and the folder if it was made for it and is empty, so
/// neither an error nor Ctrl-C leaves a half-written output; what a killed process left is removed
/// by the next one on this machine that writes to the same path.
class OutputFile {
 public:
  OutputFile(std::filesystem::path path, bool overwrite);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& temporary() const { return temporary_; }
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  bool made_folder_ = false, committed_ = false;
};

/// Writes `bytes` as an OutputFile.
void write_file(const std::filesystem::path& path, std::string_view bytes, bool overwrite);

/// The whole file. Throws data_error if it is missing, unreadable or larger than `max_bytes`.
std::string read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = 1u << 30);

/// SHA-256 of a file, as sha256sum prints it. Computed once while size and time of change stay:
/// recordings have gigabytes, and more than one part of a verb asks.
std::string sha256_of_file(const std::filesystem::path& path);

/// The same of a text.
std::string sha256_of(std::string_view text);

}  // namespace touchtrace
