#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

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
  virtual const std::map<std::string, BagTopic>& topics() const = 0;
  /// Bytes of a message, valid until the next call. Throws std::exception if it is damaged.
  virtual ByteSpan read(const BagMessage& message) = 0;
};

/// Calls `read_record` from `begin` to `end`; it returns the position of the next record. Reports a
/// file that ends early (std::out_of_range), or rethrows if `num_messages`, which `read_record`
/// counts, is still 0.
void read_records(const std::filesystem::path& file, std::uint64_t begin, std::uint64_t end,
                  const std::size_t& num_messages,
                  const std::function<std::uint64_t(std::uint64_t)>& read_record);

}  // namespace touchtrace
