#include "pipeline/acquire/import/bags/message_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_chunk_bytes = std::size_t{1} << 30;

}  // namespace

ChunkedFile::ChunkedFile(const std::filesystem::path& file)
    : file_(file), stream_(file, std::ios::binary), file_bytes_(std::filesystem::file_size(file)) {}

void ChunkedFile::read_index(std::string_view magic, std::uint64_t trailer_bytes,
                             const char* hint) {
  try {
    if (read_bytes(0, magic.size()) != magic) throw std::runtime_error("it is not a bag");
    read_records(magic.size(), file_bytes_ - trailer_bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read {}: {}", file_.string(), error.what()), hint);
  }
}

void ChunkedFile::read_records(std::uint64_t begin, std::uint64_t end) {
  Progress progress("reading the bag", end);
  std::uint64_t position = begin;
  try {
    while (position < end) {
      const std::uint64_t next = read_record(position);
      progress.advance(next - position);
      position = next;
    }
  } catch (const std::out_of_range&) {
    if (num_messages_ == 0) throw;
    Progress::warn(fmt::format("{} ends early, at byte {}; the messages before are used",
                               file_.string(), position));
  }
}

void ChunkedFile::require_bytes(std::uint64_t position, std::uint64_t size) const {
  if (position > file_bytes_ || size > file_bytes_ - position)
    throw std::out_of_range("the file ends early");
}

std::string ChunkedFile::read_bytes(std::uint64_t position, std::uint64_t size) {
  require_bytes(position, size);
  std::string bytes(size, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(position));
  if (!stream_.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw std::out_of_range("the file ends early");
  return bytes;
}

Compression ChunkedFile::compression_of(const std::string& name, Compression unsupported,
                                        const char* hint) const {
  const auto known = find_compression(name);
  if (!known || *known == unsupported)
    throw data_error(
        fmt::format("cannot read {}: compression '{}' is not supported", file_.string(), name),
        hint);
  return *known;
}

std::size_t ChunkedFile::add_chunk(std::uint64_t offset, std::size_t stored_bytes,
                                   std::size_t bytes, Compression compression) {
  if (std::max(bytes, stored_bytes) > max_chunk_bytes)
    throw std::runtime_error(
        fmt::format("a chunk of {} bytes is too large", std::max(bytes, stored_bytes)));
  chunks_.push_back({offset, stored_bytes, bytes, compression});
  return chunks_.size() - 1;
}

const std::vector<std::uint8_t>& ChunkedFile::load(std::size_t index) {
  if (index == loaded_chunk_) return loaded_;
  loaded_chunk_ = SIZE_MAX;
  const Chunk& chunk = chunks_[index];
  loaded_ = decompress(chunk.compression, bytes_of(read_bytes(chunk.offset, chunk.stored_bytes)),
                       chunk.bytes);
  loaded_chunk_ = index;
  return loaded_;
}

void ChunkedFile::add_message(const std::string& topic, const BagMessage& message) {
  if (++num_messages_ > max_messages) throw std::runtime_error("it has too many messages");
  topics_[topic].messages.push_back(message);
}

ByteSpan ChunkedFile::read(const BagMessage& message) {
  const ByteSpan bytes = load(message.chunk);
  if (message.offset > bytes.size()) throw std::out_of_range("a chunk ends early");
  return ByteReader(bytes.subspan(message.offset)).take(message.size);
}

}  // namespace touchtrace
