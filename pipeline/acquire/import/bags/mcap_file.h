#pragma once

#include <filesystem>

#include "pipeline/acquire/import/bags/message_file.h"

namespace touchtrace {

/// MCAP file (mcap.dev/spec) with messages of ROS 1 or 2, also of messages that are compressed one
/// by one.
class McapFile : public ChunkedFile {
 public:
  /// Throws data_error if the file is not an MCAP file or its chunks have an unknown compression.
  /// Reports a file that ends early.
  explicit McapFile(const std::filesystem::path& file);

  ByteSpan read(const BagMessage& message) override;

 private:
  std::uint64_t read_record(std::uint64_t position) override;
  void add_compressed(std::uint64_t content, std::size_t size);
  void index_records(std::size_t chunk);
  void add_record(std::uint8_t operation, ByteSpan content, std::size_t chunk, std::size_t offset);
  void add_channel(ByteReader content);
  void index_message(ByteSpan content, std::size_t chunk, std::size_t offset);

  std::map<std::uint16_t, std::string> types_;     ///< by the schema's number
  std::map<std::uint16_t, std::string> channels_;  ///< topic by the channel's number
  std::vector<std::uint8_t> message_;
};

bool is_mcap(const std::filesystem::path& file);

/// Type as ROS 1 writes it: "sensor_msgs/Image" of ROS 2's "sensor_msgs/msg/Image".
std::string ros_type(std::string type);

}  // namespace touchtrace
