#include "pipeline/export/mcap_writer.h"

#include <fmt/core.h>
#include <lz4frame.h>

#include "engine/base/error.h"
#include "pipeline/export/byte_writer.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_chunk_bytes = 4u << 20;
const std::string magic = "\x89MCAP0\r\n";

enum Opcode : std::uint8_t {
  op_header = 0x01,
  op_footer = 0x02,
  op_schema = 0x03,
  op_channel = 0x04,
  op_message = 0x05,
  op_chunk = 0x06,
  op_message_index = 0x07,
  op_chunk_index = 0x08,
  op_statistics = 0x0b,
  op_summary_offset = 0x0e,
  op_data_end = 0x0f
};

std::string record(std::uint8_t opcode, const std::string& content) {
  std::string bytes;
  append_numbers(bytes, opcode, std::uint64_t{content.size()});
  return bytes + content;
}

/// Text, map or array behind its length in bytes.
void append_sized(std::string& bytes, const std::string& content) {
  append_number(bytes, static_cast<std::uint32_t>(content.size()));
  bytes += content;
}

std::string lz4_frame(const std::string& bytes) {
  std::string frame(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  const std::size_t size =
      LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), nullptr);
  if (LZ4F_isError(size))
    throw failure(fmt::format("cannot compress a chunk: {}", LZ4F_getErrorName(size)),
                  "report this as a bug");
  frame.resize(size);
  return frame;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, const std::string& profile)
    : path_(path), stream_(path, std::ios::binary) {
  std::string header;
  append_sized(header, profile);
  append_sized(header, "touchtrace");
  put(magic);
  put_record(op_header, header);
}

void McapWriter::put(const std::string& bytes) {
  stream_ << bytes;
  position_ += bytes.size();
  data_crc_ = crc32(bytes, data_crc_);
}

void McapWriter::put_record(std::uint8_t opcode, const std::string& content) {
  put(record(opcode, content));
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& text) {
  std::string content;
  append_number(content, ++num_schemas_);
  for (const auto& part : {name, encoding, text}) append_sized(content, part);
  schema_records_ += record(op_schema, content);
  schema_names_.push_back(name);
  put_record(op_schema, content);
  return num_schemas_;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, const std::string& topic,
                                      const std::string& encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  std::string content;
  append_numbers(content, id, schema);
  for (const auto& part : {topic, encoding, std::string()}) append_sized(content, part);
  channel_records_ += record(op_channel, content);
  channels_.push_back({topic, schema_names_.at(schema - 1u)});
  put_record(op_channel, content);
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time_ns, const std::string& message) {
  if (chunk_.empty()) chunk_start_ns_ = time_ns;
  if (messages_ == 0) start_ns_ = time_ns;
  end_ns_ = time_ns;
  std::string content;
  append_numbers(content, channel, static_cast<std::uint32_t>(channels_.at(channel).messages),
                 time_ns, time_ns);
  index_[channel].emplace_back(time_ns, chunk_.size());
  chunk_ += record(op_message, content + message);
  ++channels_[channel].messages, ++messages_;
  if (chunk_.size() >= max_chunk_bytes) write_chunk();
}

void McapWriter::write_chunk() {
  if (chunk_.empty()) return;
  const std::string compressed = lz4_frame(chunk_);
  std::string chunk;
  append_numbers(chunk, chunk_start_ns_, end_ns_, std::uint64_t{chunk_.size()}, crc32(chunk_));
  append_sized(chunk, "lz4");
  append_number(chunk, std::uint64_t{compressed.size()});
  const std::uint64_t chunk_at = position_;
  put_record(op_chunk, chunk + compressed);
  const std::uint64_t index_at = position_;
  std::string offsets;
  for (const auto& [channel, messages] : index_) {
    append_numbers(offsets, channel, position_);
    std::string entries, content;
    for (const auto& [time_ns, offset] : messages) append_numbers(entries, time_ns, offset);
    append_number(content, channel);
    append_sized(content, entries);
    put_record(op_message_index, content);
  }
  std::string entry;
  append_numbers(entry, chunk_start_ns_, end_ns_, chunk_at, index_at - chunk_at);
  append_sized(entry, offsets);
  append_number(entry, position_ - index_at);
  append_sized(entry, "lz4");
  append_numbers(entry, std::uint64_t{compressed.size()}, std::uint64_t{chunk_.size()});
  chunk_index_records_ += record(op_chunk_index, entry);
  ++chunks_;
  chunk_.clear(), index_.clear();
}

std::string McapWriter::statistics() const {
  std::string content, counts;
  append_numbers(content, messages_, num_schemas_, static_cast<std::uint32_t>(channels_.size()),
                 std::uint32_t{0}, std::uint32_t{0}, static_cast<std::uint32_t>(chunks_), start_ns_,
                 end_ns_);
  for (std::size_t i = 0; i < channels_.size(); ++i)
    append_numbers(counts, static_cast<std::uint16_t>(i), channels_[i].messages);
  append_sized(content, counts);
  return record(op_statistics, content);
}

/// Records of the summary, then where each kind of them is, and the footer without its CRC.
std::string McapWriter::summary() {
  std::string bytes, offsets;
  const auto add_group = [&](std::uint8_t opcode, const std::string& records) {
    if (records.empty()) return;
    std::string content;
    append_numbers(content, opcode, position_ + bytes.size(), std::uint64_t{records.size()});
    offsets += record(op_summary_offset, content);
    bytes += records;
  };
  add_group(op_schema, schema_records_), add_group(op_channel, channel_records_);
  add_group(op_statistics, statistics()), add_group(op_chunk_index, chunk_index_records_);
  const std::uint64_t offsets_at = position_ + bytes.size();
  constexpr std::uint64_t footer_bytes = 20;
  bytes += offsets;
  append_numbers(bytes, std::uint8_t{op_footer}, footer_bytes, position_, offsets_at);
  return bytes;
}

void McapWriter::finish() {
  write_chunk();
  std::string crc;
  append_number(crc, data_crc_);
  put_record(op_data_end, crc);
  std::string end = summary();
  append_number(end, crc32(end));
  put(end + magic);
  stream_.flush();
  if (!stream_)
    throw failure(fmt::format("cannot write {}", path_.string()),
                  "check free disk space and write permission");
}

}  // namespace touchtrace
