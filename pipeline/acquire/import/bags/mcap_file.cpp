#include "pipeline/acquire/import/bags/mcap_file.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace touchtrace {
namespace {

constexpr std::string_view magic = "\x89MCAP0\r\n";
constexpr std::size_t record_header = 9;    // operation and length
constexpr std::size_t message_header = 22;  // channel, sequence, times of log and publication

enum Operation : std::uint8_t { schema = 3, channel = 4, message = 5, chunk_of_records = 6 };

std::string read_text(ByteReader& reader) { return reader.text(reader.number<std::uint32_t>()); }

}  // namespace

bool is_mcap(const std::filesystem::path& file) { return begins_with(file, magic); }

std::string ros_type(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

McapFile::McapFile(const std::filesystem::path& file) : ChunkedFile(file) {
  read_index(magic, magic.size(), "give a complete MCAP file; `mcap recover` repairs some");
}

std::uint64_t McapFile::read_record(std::uint64_t position) {
  const std::string start = read_bytes(position, record_header);
  ByteReader reader(bytes_of(start));
  const auto operation = reader.number<std::uint8_t>();
  const auto size = reader.number<std::uint64_t>();
  const std::uint64_t content = position + record_header;
  require_bytes(content, size);
  if (operation == chunk_of_records) add_compressed(content, size);
  if (operation == schema || operation == channel || operation == message) {
    const std::size_t chunk = add_chunk(content, size, size, Compression::none);
    add_record(operation, load(chunk), chunk, 0);
  }
  return content + size;
}

void McapFile::add_compressed(std::uint64_t content, std::size_t size) {
  const std::string start = read_bytes(content, std::min<std::size_t>(size, 1024));
  ByteReader reader(bytes_of(start));
  reader.take(16);  // times of the first and last message
  const auto bytes = reader.number<std::uint64_t>();
  reader.take(4);  // checksum
  const std::string name = read_text(reader);
  const auto stored = reader.number<std::uint64_t>();
  const std::uint64_t header = 16 + 8 + 4 + 4 + name.size() + 8;
  if (stored > size - header) throw std::runtime_error("a chunk states a wrong size");
  const Compression compression = compression_of(
      name, Compression::bz2, "`mcap compress --compression zstd IN -o OUT` writes another file");
  index_records(add_chunk(content + header, stored, bytes, compression));
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
  if (operation == message) index_message(content, chunk, offset);
}

void McapFile::add_channel(ByteReader content) {
  const auto number = content.number<std::uint16_t>(), type = content.number<std::uint16_t>();
  const std::string topic = read_text(content), encoding = read_text(content);
  if (encoding != "cdr" && encoding != "ros1") return;
  channels_[number] = topic;
  topics_[topic].type = types_[type];
  topics_[topic].serialization = encoding == "cdr" ? RosSerialization::cdr : RosSerialization::ros1;
}

void McapFile::index_message(ByteSpan content, std::size_t chunk, std::size_t offset) {
  ByteReader reader(content);
  const auto channel_number = reader.number<std::uint16_t>();
  reader.take(4);  // sequence
  const auto log_time_ns = reader.number<std::uint64_t>();
  reader.take(8);  // time of publication
  const auto topic = channels_.find(channel_number);
  if (topic == channels_.end()) return;  // of another encoding
  add_message(topic->second, {1e-9 * static_cast<double>(log_time_ns), chunk,
                              offset + message_header, content.size() - message_header});
}

ByteSpan McapFile::read(const BagMessage& message) {
  return plain_message(ChunkedFile::read(message), message_);
}

}  // namespace touchtrace
