#include "pipeline/acquire/import/bags/bag_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
constexpr std::size_t max_chunk_bytes = std::size_t{1} << 30;
constexpr std::size_t max_header_bytes = 1u << 20;
constexpr const char* hint = "give a complete bag of ROS 1; `rosbag reindex` repairs some";

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

BagFile::BagFile(std::filesystem::path file)
    : file_(std::move(file)),
      stream_(file_, std::ios::binary),
      file_bytes_(std::filesystem::file_size(file_)) {
  try {
    if (read_bytes(magic.size()) != magic) throw std::runtime_error("it is not a bag");
    read_index();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(describe(error.what()), hint);
  }
}

std::string BagFile::describe(const std::string& fault) const {
  return fmt::format("cannot read {}: {}", file_.string(), fault);
}

std::string BagFile::read_bytes(std::uint64_t size) {
  const auto position = static_cast<std::uint64_t>(stream_.tellg());
  if (!stream_ || size > file_bytes_ - std::min(position, file_bytes_))
    throw std::out_of_range("the file ends early");
  std::string bytes(size, '\0');
  if (!stream_.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw std::out_of_range("the file ends early");
  return bytes;
}

BagFile::Fields BagFile::read_header() {
  const auto size = ByteReader(bytes_of(read_bytes(4))).number<std::uint32_t>();
  if (size > max_header_bytes) throw std::runtime_error("a record's header is too long");
  return parse_fields(ByteReader(bytes_of(read_bytes(size))));
}

void BagFile::read_index() {
  read_records(file_, magic.size(), file_bytes_, num_messages_,
               [this](std::uint64_t position) { return read_record(position); });
}

std::uint64_t BagFile::read_record(std::uint64_t position) {
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(position));
  const Fields fields = read_header();
  const auto size = ByteReader(bytes_of(read_bytes(4))).number<std::uint32_t>();
  const auto data = static_cast<std::uint64_t>(stream_.tellg());
  if (size > file_bytes_ - data) throw std::out_of_range("the file ends early");
  const auto operation = field_value<std::uint8_t>(fields, "op");
  if (operation == connection_data) add_connection(fields, read_bytes(size));
  if (operation == chunk_data) add_chunk(fields, size);
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

void BagFile::add_chunk(const Fields& fields, std::size_t stored_bytes) {
  const auto compression = fields.find("compression");
  const std::string name = compression == fields.end() ? "none" : compression->second;
  const auto known = find_compression(name);
  if (!known || *known == Compression::zstd)
    throw data_error(describe(fmt::format("compression '{}' is not supported", name)),
                     "`rosbag decompress FILE` writes an uncompressed bag");
  const Chunk chunk{static_cast<std::uint64_t>(stream_.tellg()), stored_bytes,
                    field_value<std::uint32_t>(fields, "size"), *known};
  if (std::max(chunk.bytes, chunk.stored_bytes) > max_chunk_bytes)
    throw std::runtime_error(fmt::format("a chunk of {} bytes is too large", chunk.bytes));
  chunks_.push_back(chunk);
  index_chunk(chunks_.size() - 1);
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
    if (++num_messages_ > max_messages) throw std::runtime_error("it has too many messages");
    topics_[topic->second].messages.push_back(
        {seconds(field_value<std::uint64_t>(fields, "time")), chunk,
         static_cast<std::size_t>(data.data() - bytes.data()), data.size()});
  }
}

const std::vector<std::uint8_t>& BagFile::load(std::size_t index) {
  if (index == loaded_chunk_) return loaded_;
  loaded_chunk_ = SIZE_MAX;
  const Chunk& chunk = chunks_[index];
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(chunk.offset));
  loaded_ = decompress(chunk.compression, bytes_of(read_bytes(chunk.stored_bytes)), chunk.bytes);
  loaded_chunk_ = index;
  return loaded_;
}

ByteSpan BagFile::read(const BagMessage& message) {
  const auto& bytes = load(message.chunk);
  return ByteReader(ByteSpan(bytes).subspan(message.offset)).take(message.size);
}

}  // namespace touchtrace
