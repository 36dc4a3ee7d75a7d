#include <fcntl.h>
#include <fmt/core.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/error.h"
#include "pipeline/acquire/record/log_format.h"

namespace touchtrace {
namespace {

Error write_error(const std::filesystem::path& path, int error) {
  return failure(fmt::format("cannot write {}: {}", path.string(), std::strerror(error)),
                 fmt::format("its frames are kept: free some space, then `touchtrace recover {}`",
                             path.string()));
}

/// Makes the name of a new file survive a loss of power.
void sync_folder_of(const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path();
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);  // some file systems have no such call for folders
  close(descriptor);
}

}  // namespace

LogWriter::LogWriter(const std::filesystem::path& path)
    : path_(path),
      file_(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666)) {
  if (file_ < 0 && errno == EEXIST)
    throw usage_error(fmt::format("{} exists: a recording was interrupted", path.string()),
                      fmt::format("`touchtrace recover {}` finishes it", path.string()));
  if (file_ < 0)
    throw failure(fmt::format("cannot create {}: {}", path.string(), std::strerror(errno)),
                  "choose an output in a writable folder");
  if (::write(file_, log_magic.data(), log_magic.size()) != ssize_t{log_magic.size()}) {
    const int error = errno;
    close(file_);
    throw write_error(path, error);
  }
  sync_folder_of(path);
  bytes_ = log_magic.size();
}

LogWriter::~LogWriter() { close(file_); }

void LogWriter::append(RecordKind kind, std::span<const std::uint8_t> payload) {
  if (payload.size() > max_payload_bytes)
    throw failure(fmt::format("a record of {} bytes is too large", payload.size()),
                  "record smaller images");
  RecordHeader header;
  header.kind = static_cast<std::uint32_t>(kind);
  header.payload_bytes = static_cast<std::uint32_t>(payload.size());
  header.payload_crc = crc32c(payload);
  header.number = number_;
  header.header_crc = header.computed_crc();
  const iovec parts[]{{&header, sizeof header},
                      {const_cast<std::uint8_t*>(payload.data()), payload.size()}};
  const ssize_t total = static_cast<ssize_t>(sizeof header + payload.size());
  if (const ssize_t written = writev(file_, parts, 2); written != total)
    throw write_error(path_, written < 0 ? errno : ENOSPC);
  ++number_;
  bytes_ += static_cast<std::uint64_t>(total);
}

void LogWriter::sync() {
  if (fdatasync(file_) != 0) throw write_error(path_, errno);
}

}  // namespace touchtrace
