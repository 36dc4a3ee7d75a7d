#include "pipeline/export/zip_writer.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "pipeline/export/byte_writer.h"

namespace touchtrace {
namespace {

constexpr std::uint16_t zip_version = 20, no_flags = 0, stored_method = 0, midnight = 0;
constexpr std::uint16_t date_1980 = 1 << 5 | 1;      // month and day; the year counts from 1980
constexpr std::uint64_t max_zip_bytes = 0xfffffffe;  // beyond it the format has other records

}  // namespace

ZipWriter::ZipWriter(const std::filesystem::path& path)
    : path_(path), stream_(path, std::ios::binary) {}

void ZipWriter::add(const std::string& name, const std::string& content) {
  if (size_ + content.size() + directory_.size() > max_zip_bytes)
    throw data_error(fmt::format("{} would be larger than 4 GiB", path_.string()),
                     "export csv, or a shorter recording");
  const auto bytes = static_cast<std::uint32_t>(content.size());
  std::string common;  // what the local header and the directory share
  append_numbers(common, zip_version, no_flags, stored_method, midnight, date_1980, crc32(content),
                 bytes, bytes, static_cast<std::uint16_t>(name.size()), std::uint16_t{0});
  const std::string header = "PK\3\4" + common + name;
  directory_ += "PK\1\2";
  append_number(directory_, zip_version);
  directory_ += common;
  append_numbers(directory_, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0},
                 static_cast<std::uint32_t>(size_));
  directory_ += name;
  stream_ << header << content;
  size_ += header.size() + content.size();
  ++files_;
}

void ZipWriter::finish() {
  std::string end = "PK\5\6";
  append_numbers(end, std::uint16_t{0}, std::uint16_t{0}, files_, files_,
                 static_cast<std::uint32_t>(directory_.size()), static_cast<std::uint32_t>(size_),
                 std::uint16_t{0});
  stream_ << directory_ << end << std::flush;
  if (!stream_)
    throw failure(fmt::format("cannot write {}", path_.string()),
                  "check free disk space and write permission");
}

}  // namespace touchtrace
