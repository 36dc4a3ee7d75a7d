#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace touchtrace {

/// Kinds of records of a log. The values are part of the format.
enum class RecordKind : std::uint32_t {
  description = 1,  ///< SessionInfo as JSON
  glove_frame,      ///< sequence, host time, counts
  color_image,      ///< sequence, host and device time, pixels
  depth_image,      ///< sequence, host and device time, pixels
  reconnection      ///< the glove was plugged in again or restarted
};

/// Appends records to a new file, each with one system call, so that a killed process loses none
/// that append() returned for. Layout: pipeline/acquire/README.md. Throws failure if the disk is
/// full.
class LogWriter {
 public:
  /// Throws usage_error if the file exists.
  explicit LogWriter(const std::filesystem::path& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void append(RecordKind kind, std::span<const std::uint8_t> payload);
  /// Makes all records survive a loss of power.
  void sync();
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::filesystem::path path_;
  int file_;
  std::uint64_t number_ = 0, bytes_ = 0;
};

struct LogRecord {
  RecordKind kind;
  std::span<const std::uint8_t> payload;  ///< valid until the next one is read
};

/// Parts of a log that cannot be read.
struct LogDamage {
  std::uint64_t lost_records = 0;   ///< damaged, or missing by the numbers of the others
  std::uint64_t damaged_bytes = 0;  ///< between valid records
  std::uint64_t torn_bytes = 0;     ///< behind the last valid record

  bool is_torn_only() const { return lost_records == 0 && damaged_bytes == 0; }
};

/// Reads the valid records of a log. Safe for untrusted files; its time grows linearly with the
/// file's size.
class LogReader {
 public:
  /// Throws data_error if the file cannot be read or has no valid record.
  explicit LogReader(const std::filesystem::path& path);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// Next valid record; nullopt at the end.
  std::optional<LogRecord> next();
  /// Damage of the part that has been read.
  const LogDamage& damage() const { return damage_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t position() const { return position_; }

 private:
  bool read(std::uint64_t at, std::span<std::uint8_t> bytes) const;
  std::uint64_t find_header(std::uint64_t from) const;

  int file_;
  std::uint64_t size_ = 0, position_ = 0, next_number_ = 0;
  std::vector<std::uint8_t> payload_;
  LogDamage damage_;
};

}  // namespace touchtrace
