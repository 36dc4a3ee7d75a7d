#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "engine/base/error.h"
#include "pipeline/acquire/record/log_format.h"

namespace touchtrace {
namespace {

bool is_header(const std::uint8_t* bytes) {
  if (std::memcmp(bytes, &record_marker, sizeof record_marker) != 0) return false;
  RecordHeader header;
  std::memcpy(&header, bytes, sizeof header);
  return header.is_valid();
}

}  // namespace

LogReader::LogReader(const std::filesystem::path& path)
    : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat status {};
  if (file_ < 0 || fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    if (file_ >= 0) close(file_);
    throw data_error(fmt::format("cannot read {}", path.string()), "check the path");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
  std::array<std::uint8_t, log_magic.size()> magic{};
  const bool is_log = read(0, magic) && magic == log_magic;
  position_ = find_header(is_log ? log_magic.size() : 0);
  if (!is_log && position_ == size_) {
    close(file_);
    throw data_error(fmt::format("{} is not a log of `touchtrace record`", path.string()),
                     "give the file OUTPUT.log that an interrupted `record` left");
  }
  damage_.damaged_bytes = is_log ? 0 : log_magic.size();
  position_ = log_magic.size();
}

LogReader::~LogReader() { close(file_); }

bool LogReader::read(std::uint64_t at, std::span<std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t size = pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return false;
    at += static_cast<std::uint64_t>(size);
    bytes = bytes.subspan(static_cast<std::size_t>(size));
  }
  return true;
}

/// Position of the first valid record header at or behind `from`; size() if there is none. The
/// chunks grow, so that its time is proportional to the distance.
std::uint64_t LogReader::find_header(std::uint64_t from) const {
  constexpr std::size_t max_chunk = 1 << 16;
  std::vector<std::uint8_t> chunk(sizeof(RecordHeader));
  while (from + sizeof(RecordHeader) <= size_) {
    chunk.resize(std::min<std::uint64_t>(chunk.size(), size_ - from));
    if (!read(from, chunk)) return size_;
    const std::size_t candidates = chunk.size() - sizeof(RecordHeader) + 1;
    for (std::size_t at = 0; at < candidates; ++at)
      if (is_header(&chunk[at])) return from + at;
    from += candidates;
    chunk.resize(std::min(max_chunk, 2 * chunk.size()));
  }
  return size_;
}

std::optional<LogRecord> LogReader::next() {
  for (;;) {
    const std::uint64_t start = std::exchange(position_, find_header(position_));
    RecordHeader header;
    if (!read(position_, {reinterpret_cast<std::uint8_t*>(&header), sizeof header}) ||
        header.payload_bytes > size_ - position_ - sizeof header) {
      damage_.torn_bytes += size_ - start;
      position_ = size_;
      return std::nullopt;
    }
    damage_.damaged_bytes += position_ - start;
    payload_.resize(header.payload_bytes);
    const bool is_whole =
        read(position_ + sizeof header, payload_) && crc32c(payload_) == header.payload_crc;
    position_ += sizeof header + header.payload_bytes;
    const bool is_next = header.number >= next_number_;
    if (is_next)
      damage_.lost_records += header.number - std::exchange(next_number_, header.number + 1);
    if (is_whole && is_next) return LogRecord{static_cast<RecordKind>(header.kind), payload_};
    ++damage_.lost_records;
    damage_.damaged_bytes += sizeof header + header.payload_bytes;
  }
}

}  // namespace touchtrace
