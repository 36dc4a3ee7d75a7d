#include "pipeline/acquire/import/formats/zip_file.h"

#include <fmt/core.h>
#include <libdeflate.h>

#include <memory>
#include <new>
#include <stdexcept>

#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {
namespace {

constexpr std::uint32_t max_deflate_ratio = 1032;

ByteReader reader_at(const std::string& archive, std::size_t offset) {
  if (offset > archive.size()) throw std::out_of_range("the archive ends early");
  return ByteReader(bytes_of(archive).subspan(offset));
}

ZipEntry read_entry(ByteReader& reader) {
  if (reader.text(4) != "PK\1\2") throw std::runtime_error("the archive's directory is damaged");
  ZipEntry entry;
  reader.take(6);
  entry.method = reader.number<std::uint16_t>();
  reader.take(8);
  entry.stored_bytes = reader.number<std::uint32_t>();
  entry.bytes = reader.number<std::uint32_t>();
  const auto name = reader.number<std::uint16_t>(), extra = reader.number<std::uint16_t>(),
             comment = reader.number<std::uint16_t>();
  reader.take(8);
  entry.local_header = reader.number<std::uint32_t>();
  entry.name = reader.text(name);
  reader.take(extra), reader.take(comment);
  return entry;
}

std::string inflate(ByteSpan stored, std::uint32_t bytes) {
  if (bytes / max_deflate_ratio > stored.size())
    throw std::runtime_error("a compressed file states a size that is too large");
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>
      decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  std::string content(bytes, '\0');
  if (libdeflate_deflate_decompress(decompressor.get(), stored.data(), stored.size(),
                                    content.data(), content.size(), nullptr) != LIBDEFLATE_SUCCESS)
    throw std::runtime_error("a compressed file is damaged");
  return content;
}

}  // namespace

std::vector<ZipEntry> zip_entries(const std::string& archive) {
  const auto end = archive.rfind("PK\5\6");
  if (end == std::string::npos) throw std::runtime_error("not a zip archive");
  ByteReader trailer = reader_at(archive, end);
  trailer.take(10);
  const auto count = trailer.number<std::uint16_t>();
  trailer.take(4);
  ByteReader directory = reader_at(archive, trailer.number<std::uint32_t>());
  std::vector<ZipEntry> entries;
  for (int i = 0; i < count; ++i) entries.push_back(read_entry(directory));
  return entries;
}

std::string zip_content(const std::string& archive, const ZipEntry& entry) {
  ByteReader reader = reader_at(archive, entry.local_header);
  reader.take(26);
  const auto name = reader.number<std::uint16_t>(), extra = reader.number<std::uint16_t>();
  reader.take(name), reader.take(extra);
  const ByteSpan stored = reader.take(entry.stored_bytes);
  if (entry.method == 8) return inflate(stored, entry.bytes);
  if (entry.method != 0)
    throw std::runtime_error(fmt::format("compression method {} is not supported", entry.method));
  return {reinterpret_cast<const char*>(stored.data()), stored.size()};
}

}  // namespace touchtrace
