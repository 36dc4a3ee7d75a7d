#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchtrace {

/// Name of this machine; empty if it is not known.
std::string host_name();

/// Output file that is written atomically.
///
/// The caller writes to temporary(), in the same folder; commit() calls fsync, renames it to path()
/// and calls fsync on the folder. Without commit() the destructor removes the temporary file, and
/// the folder if the constructor created it and it is empty. Neither an error nor Ctrl-C therefore
/// leaves a partial output. Temporary files of killed processes are removed by the next OutputFile
/// for the same path on the same machine.
class OutputFile {
 public:
  /// Creates missing folders. Throws usage_error if `path` exists and `overwrite` is false.
  OutputFile(std::filesystem::path path, bool overwrite);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& temporary() const { return temporary_; }
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  bool created_folder_ = false, committed_ = false;
};

/// Writes `bytes` to an OutputFile.
void write_file(const std::filesystem::path& path, std::string_view bytes, bool overwrite);

/// Reads a whole file. Throws data_error if it is missing, unreadable or larger than `max_bytes`.
std::string read_file(const std::filesystem::path& path, std::uintmax_t max_bytes = 1u << 30);

/// SHA-256 of a file in hexadecimal, as printed by sha256sum. Cached by path, size and modification
/// time, because recordings are gigabytes and are hashed more than once per command.
std::string sha256_of_file(const std::filesystem::path& path);

/// SHA-256 of a text in hexadecimal.
std::string sha256_of(std::string_view text);

}  // namespace touchtrace
