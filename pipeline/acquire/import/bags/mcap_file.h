#pragma once

#include <filesystem>
#include <fstream>

#include "pipeline/acquire/import/bags/decompress.h"
#include "pipeline/acquire/import/bags/message_file.h"

namespace touchtrace {

/// MCAP file (mcap.dev/spec) with messages of ROS 1 or 2. The index is made by reading the whole
/// file once, so that unindexed and truncated files can be read, too, also of messages that are
/// compressed one by one. Memory: one chunk and one message. Safe for untrusted files.
class McapFile : public MessageFile {
 public:
  /// Throws data_error if the file is not an MCAP file or its chunks have an unknown compression.
  /// Reports a file that ends early.
  explicit McapFile(std::filesystem::path file);

  const std::map<std::string, BagTopic>& topics() const override { return topics_; }
  ByteSpan read(const BagMessage& message) override;

 private:
  /// Bytes of records in the file.
  struct Chunk {
    std::uint64_t offset = 0;
    std::size_t stored_bytes = 0, bytes = 0;
    Compression compression = Compression::none;
  };

  void read_index();
  /// Returns the position of the next record.
  std::uint64_t read_record(std::uint64_t position);
  void add_chunk(std::uint64_t content, std::size_t size);
  void index_records(std::size_t chunk);
  void add_record(std::uint8_t operation, ByteSpan content, std::size_t chunk, std::size_t offset);
  void add_channel(ByteReader content);
  void add_message(ByteSpan content, std::size_t chunk, std::size_t offset);
  const std::vector<std::uint8_t>& load(std::size_t chunk);
  std::string read_bytes(std::uint64_t position, std::uint64_t size);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::vector<Chunk> chunks_;
  std::map<std::uint16_t, std::string> types_;     ///< by the schema's number
  std::map<std::uint16_t, std::string> channels_;  ///< topic by the channel's number
  std::map<std::string, BagTopic> topics_;
  std::vector<std::uint8_t> loaded_, message_;
  std::size_t loaded_chunk_ = SIZE_MAX, num_messages_ = 0;
};

bool is_mcap(const std::filesystem::path& file);

/// Type as ROS 1 writes it: "sensor_msgs/Image" of ROS 2's "sensor_msgs/msg/Image".
std::string ros_type(std::string type);

}  // namespace touchtrace
