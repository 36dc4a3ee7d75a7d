#include "pipeline/acquire/import/bags/mcap_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr std::string_view magic = "\x89MCAP0\r\n";
constexpr std::size_t max_chunk_bytes = std::size_t{1} << 30;
constexpr std::size_t record_header = 9;    // operation and length
constexpr std::size_t message_header = 22;  // channel, sequence, times of log and publication

enum Operation : std::uint8_t { schema = 3, channel = 4, message = 5, chunk_of_records = 6 };

std::string read_text(ByteReader& reader) { return reader.text(reader.number<std::uint32_t>()); }

}  // namespace

bool is_mcap(const std::filesystem::path& file) {
  std::string start(magic.size(), '\0');
  return std::filesystem::is_regular_file(file) &&
         std::ifstream(file, std::ios::binary)
             .read(start.data(), static_cast<std::streamsize>(start.size())) &&
         start == magic;
}

std::string ros_type(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

McapFile::McapFile(std::filesystem::path file)
    : file_(std::move(file)),
      stream_(file_, std::ios::binary),
      file_bytes_(std::filesystem::file_size(file_)) {
  try {
    read_index();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read {}: {}", file_.string(), error.what()),
                     "give a complete MCAP file; `mcap recover` repairs some");
  }
}

std::string McapFile::read_bytes(std::uint64_t position, std::uint64_t size) {
  if (position > file_bytes_ || size > file_bytes_ - position)
    throw std::out_of_range("the file ends early");
  std::string bytes(size, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(position));
  if (!stream_.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw std::out_of_range("the file ends early");
  return bytes;
}

void McapFile::read_index() {
  read_records(file_, magic.size(),
               file_bytes_ - std::min<std::uint64_t>(file_bytes_, magic.size()), num_messages_,
               [this](std::uint64_t position) { return read_record(position); });
}

std::uint64_t McapFile::read_record(std::uint64_t position) {
  const std::string start = read_bytes(position, record_header);
  ByteReader reader(bytes_of(start));
  const auto operation = reader.number<std::uint8_t>();
  const auto size = reader.number<std::uint64_t>();
  const std::uint64_t content = position + record_header;
  if (size > file_bytes_ - content) throw std::out_of_range("the file ends early");
  if (size > max_chunk_bytes)
    throw std::runtime_error(fmt::format("a record of {} bytes is too large", size));
  if (operation == chunk_of_records) add_chunk(content, size);
  if (operation == schema || operation == channel || operation == message) {
    chunks_.push_back({content, size, size, Compression::none});
    add_record(operation, load(chunks_.size() - 1), chunks_.size() - 1, 0);
  }
  return content + size;
}

void McapFile::add_chunk(std::uint64_t content, std::size_t size) {
  const std::string start = read_bytes(content, std::min<std::size_t>(size, 1024));
  ByteReader reader(bytes_of(start));
  reader.take(16);  // times of the first and last message
  const auto bytes = reader.number<std::uint64_t>();
  reader.take(4);  // checksum
  const std::string name = read_text(reader);
  const auto stored = reader.number<std::uint64_t>();
  const std::uint64_t header = 16 + 8 + 4 + 4 + name.size() + 8;
  if (stored > size - header || bytes > max_chunk_bytes)
    throw std::runtime_error("a chunk states a wrong size");
  const auto compression = find_compression(name);
  if (!compression || *compression == Compression::bz2)
    throw data_error(fmt::format("{}: compression '{}' is not supported", file_.string(), name),
                     "`mcap compress --compression zstd IN -o OUT` writes another file");
  chunks_.push_back({content + header, stored, bytes, *compression});
  index_records(chunks_.size() - 1);
}

void McapFile::index_records(std::size_t chunk) {
  const auto& bytes = load(chunk);
  ByteReader reader(bytes);
  while (!reader.is_at_end()) {
    const auto operation = reader.number<std::uint8_t>();
    const ByteSpan content = reader.take(reader.number<std::uint64_t>());
    add_record(operation, content, chunk, static_cast<std::size_t>(content.data() - bytes.data()));
  }
}

void McapFile::add_record(std::uint8_t operation, ByteSpan content, std::size_t chunk,
                          std::size_t offset) {
  ByteReader reader(content);
  if (operation == schema) {
    const auto number = reader.number<std::uint16_t>();
    types_[number] = ros_type(read_text(reader));
  }
  if (operation == channel) add_channel(reader);
  if (operation == message) add_message(content, chunk, offset);
}

void McapFile::add_channel(ByteReader content) {
  const auto number = content.number<std::uint16_t>(), type = content.number<std::uint16_t>();
  const std::string topic = read_text(content), encoding = read_text(content);
  if (encoding != "cdr" && encoding != "ros1") return;
  channels_[number] = topic;
  topics_[topic].type = types_[type];
  topics_[topic].serialization = encoding == "cdr" ? RosSerialization::cdr : RosSerialization::ros1;
}

void McapFile::add_message(ByteSpan content, std::size_t chunk, std::size_t offset) {
  ByteReader reader(content);
  const auto channel_number = reader.number<std::uint16_t>();
  reader.take(4);  // sequence
  const auto log_time_ns = reader.number<std::uint64_t>();
  reader.take(8);  // time of publication
  const auto topic = channels_.find(channel_number);
  if (topic == channels_.end()) return;  // of another encoding
  if (++num_messages_ > max_messages) throw std::runtime_error("it has too many messages");
  topics_[topic->second].messages.push_back({1e-9 * static_cast<double>(log_time_ns), chunk,
                                             offset + message_header,
                                             content.size() - message_header});
}

const std::vector<std::uint8_t>& McapFile::load(std::size_t index) {
  if (index == loaded_chunk_) return loaded_;
  loaded_chunk_ = SIZE_MAX;
  const Chunk& chunk = chunks_[index];
  loaded_ = decompress(chunk.compression, bytes_of(read_bytes(chunk.offset, chunk.stored_bytes)),
                       chunk.bytes);
  loaded_chunk_ = index;
  return loaded_;
}

ByteSpan McapFile::read(const BagMessage& message) {
  const ByteSpan bytes = load(message.chunk);
  if (message.offset > bytes.size()) throw std::out_of_range("a chunk ends early");
  return plain_message(ByteReader(bytes.subspan(message.offset)).take(message.size), message_);
}

}  // namespace touchtrace
