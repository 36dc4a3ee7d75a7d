#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// Writes an MCAP file (mcap.dev/spec): schemas and channels, chunks of about 4 MiB compressed with
/// LZ4, message indices, and a summary, so that readers can seek. All parts have CRCs.
class McapWriter {
 public:
  struct Channel {
    std::string topic, type;
    std::uint64_t messages = 0;
  };

  /// `profile`: "ros2" or empty.
  McapWriter(const std::filesystem::path& path, const std::string& profile);

  std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                           const std::string& text);
  /// `schema`: from add_schema(). `encoding`: of the messages.
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic,
                            const std::string& encoding);
  /// Messages must come in order of their times. `time_ns`: Unix time.
  void write(std::uint16_t channel, std::uint64_t time_ns, const std::string& message);
  /// Writes the summary. Throws failure if the disk is full.
  void finish();

  const std::vector<Channel>& channels() const { return channels_; }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t start_ns() const { return start_ns_; }
  std::uint64_t end_ns() const { return end_ns_; }

 private:
  /// Time and position in the chunk of each message, by channel.
  using MessageIndex =
      std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;

  void put(const std::string& bytes);
  void put_record(std::uint8_t opcode, const std::string& content);
  void write_chunk();
  std::string statistics() const;
  std::string summary();

  std::filesystem::path path_;
  std::ofstream stream_;
  std::uint64_t position_ = 0, messages_ = 0, start_ns_ = 0, end_ns_ = 0, chunks_ = 0;
  std::uint64_t chunk_start_ns_ = 0;
  std::uint32_t data_crc_ = 0;
  std::uint16_t num_schemas_ = 0;
  std::vector<Channel> channels_;
  std::vector<std::string> schema_names_;
  std::string chunk_, schema_records_, channel_records_, chunk_index_records_;
  MessageIndex index_;
};

}  // namespace touchtrace
