#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/acquire/import/bags/decompress.h"
#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {

/// Largest number of messages in a file.
inline constexpr std::size_t max_messages = 10'000'000;

/// Message of a bag, not read yet.
struct BagMessage {
  double record_time_s = 0.0;        ///< Unix time at which it was recorded
  std::size_t chunk = 0;             ///< index
  std::size_t offset = 0, size = 0;  ///< in the chunk
};

/// How messages are written as bytes: by ROS 1, or in OMG's Common Data Representation by ROS 2.
enum class RosSerialization { ros1, cdr };

struct BagTopic {
  std::string type;  ///< "sensor_msgs/Image"
  std::vector<BagMessage> messages;
  RosSerialization serialization = RosSerialization::ros1;
};

/// File with messages of ROS. Its index is in memory, its messages are not.
class MessageFile {
 public:
  virtual ~MessageFile() = default;

  /// By name, with messages in the order of the file.
  const std::map<std::string, BagTopic>& topics() const { return topics_; }
  /// Bytes of a message, valid until the next call. Throws std::exception if it is damaged.
  virtual ByteSpan read(const BagMessage& message) = 0;

 protected:
  std::map<std::string, BagTopic> topics_;
};

/// File of records, some of which are compressed chunks of records. The index is made by reading
/// the whole file once, so that unindexed and truncated files can be read, too. Memory: one chunk.
/// Safe for untrusted files.
class ChunkedFile : public MessageFile {
 public:
  ByteSpan read(const BagMessage& message) override;

 protected:
  explicit ChunkedFile(const std::filesystem::path& file);

  /// Calls read_record() for each record between `magic` and the last `trailer_bytes` of the file.
  /// Reports a file that ends early behind a message. Throws data_error for any other fault.
  void read_index(std::string_view magic, std::uint64_t trailer_bytes, const char* hint);
  /// Returns the position of the next record. Throws std::out_of_range if the file ends early.
  virtual std::uint64_t read_record(std::uint64_t position) = 0;

  std::string read_bytes(std::uint64_t position, std::uint64_t size);
  /// Throws std::out_of_range unless `size` bytes are at the position, which is in the file.
  void require_bytes(std::uint64_t position, std::uint64_t size) const;
  /// Compression by its name. Throws data_error if it is unknown or `unsupported`.
  Compression compression_of(const std::string& name, Compression unsupported,
                             const char* hint) const;
  /// Bytes of records in the file. Returns the chunk's index.
  std::size_t add_chunk(std::uint64_t offset, std::size_t stored_bytes, std::size_t bytes,
                        Compression compression);
  /// Content of a chunk, valid until the next call.
  const std::vector<std::uint8_t>& load(std::size_t chunk);
  void add_message(const std::string& topic, const BagMessage& message);

 private:
  struct Chunk {
    std::uint64_t offset = 0;
    std::size_t stored_bytes = 0, bytes = 0;
    Compression compression = Compression::none;
  };

  void read_records(std::uint64_t begin, std::uint64_t end);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<std::uint8_t> loaded_;
  std::size_t loaded_chunk_ = SIZE_MAX, num_messages_ = 0;
};

}  // namespace touchtrace
