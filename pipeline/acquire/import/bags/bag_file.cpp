#include "pipeline/acquire/import/bags/bag_file.h"

#include <stdexcept>
#include <string_view>

namespace touchtrace {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
constexpr std::size_t max_header_bytes = 1u << 20;
constexpr std::uint64_t size_bytes = 4;  // of the size before a record's header and data

enum Operation : std::uint8_t { message_data = 2, chunk_data = 5, connection_data = 7 };

/// Fields `name=value` of a record's header.
std::map<std::string, std::string> parse_fields(ByteReader reader) {
  std::map<std::string, std::string> fields;
  while (!reader.is_at_end()) {
    const std::string field = reader.text(reader.number<std::uint32_t>());
    const auto equals = field.find('=');
    if (equals == std::string::npos) throw std::runtime_error("a record's header is damaged");
    fields[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

template <class T>
T field_value(const std::map<std::string, std::string>& fields, const std::string& name) {
  const auto field = fields.find(name);
  if (field == fields.end()) throw std::runtime_error("a record has no field " + name);
  return ByteReader(bytes_of(field->second)).number<T>();
}

/// Seconds of a ROS time: low word seconds, high word nanoseconds.
double seconds(std::uint64_t time) {
  return static_cast<double>(time & 0xffffffffu) + 1e-9 * static_cast<double>(time >> 32);
}

}  // namespace

BagFile::BagFile(const std::filesystem::path& file) : ChunkedFile(file) {
  read_index(magic, 0, "give a complete bag of ROS 1; `rosbag reindex` repairs some");
}

std::uint32_t BagFile::read_size(std::uint64_t position) {
  return ByteReader(bytes_of(read_bytes(position, size_bytes))).number<std::uint32_t>();
}

std::uint64_t BagFile::read_record(std::uint64_t position) {
  const std::uint64_t header_size = read_size(position), header = position + size_bytes;
  if (header_size > max_header_bytes) throw std::runtime_error("a record's header is too long");
  const Fields fields = parse_fields(ByteReader(bytes_of(read_bytes(header, header_size))));
  const std::uint64_t size = read_size(header + header_size),
                      data = header + header_size + size_bytes;
  require_bytes(data, size);
  const auto operation = field_value<std::uint8_t>(fields, "op");
  if (operation == connection_data) add_connection(fields, read_bytes(data, size));
  if (operation == chunk_data) {
    const auto name = fields.find("compression");
    const Compression compression =
        compression_of(name == fields.end() ? "none" : name->second, Compression::zstd,
                       "`rosbag decompress FILE` writes an uncompressed bag");
    index_chunk(add_chunk(data, size, field_value<std::uint32_t>(fields, "size"), compression));
  }
  return data + size;
}

void BagFile::add_connection(const Fields& fields, const std::string& data) {
  const auto topic = fields.find("topic");
  const auto description = parse_fields(ByteReader(bytes_of(data)));
  const auto type = description.find("type");
  if (topic == fields.end() || type == description.end())
    throw std::runtime_error("a connection has no topic or type");
  connections_[field_value<std::uint32_t>(fields, "conn")] = topic->second;
  topics_[topic->second].type = type->second;
}

void BagFile::index_chunk(std::size_t chunk) {
  const auto& bytes = load(chunk);
  ByteReader reader(bytes);
  while (!reader.is_at_end()) {
    const auto fields = parse_fields(ByteReader(reader.take(reader.number<std::uint32_t>())));
    const ByteSpan data = reader.take(reader.number<std::uint32_t>());
    const auto operation = field_value<std::uint8_t>(fields, "op");
    if (operation == connection_data)
      add_connection(fields, {reinterpret_cast<const char*>(data.data()), data.size()});
    if (operation != message_data) continue;
    const auto topic = connections_.find(field_value<std::uint32_t>(fields, "conn"));
    if (topic == connections_.end()) throw std::runtime_error("a message has no connection");
    add_message(topic->second, {seconds(field_value<std::uint64_t>(fields, "time")), chunk,
                                static_cast<std::size_t>(data.data() - bytes.data()), data.size()});
  }
}

}  // namespace touchtrace
