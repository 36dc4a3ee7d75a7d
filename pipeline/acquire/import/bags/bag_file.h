#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "pipeline/acquire/import/bags/decompress.h"
#include "pipeline/acquire/import/bags/message_file.h"

namespace touchtrace {

/// Bag of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0). The index is made by reading the whole
/// file once, so that unindexed and truncated bags can be read, too. Memory: one chunk. Safe for
/// untrusted files.
class BagFile : public MessageFile {
 public:
  /// Throws data_error if the file is not a bag or its chunks have an unknown compression. Reports
  /// a bag that ends early.
  explicit BagFile(std::filesystem::path file);

  const std::map<std::string, BagTopic>& topics() const override { return topics_; }
  ByteSpan read(const BagMessage& message) override;

 private:
  struct Chunk {
    std::uint64_t offset = 0;  ///< of the stored bytes in the file
    std::size_t stored_bytes = 0, bytes = 0;
    Compression compression = Compression::none;
  };
  using Fields = std::map<std::string, std::string>;

  void read_index();
  /// Returns the position of the next record.
  std::uint64_t read_record(std::uint64_t position);
  Fields read_header();
  void add_chunk(const Fields& fields, std::size_t stored_bytes);
  void add_connection(const Fields& fields, const std::string& data);
  void index_chunk(std::size_t chunk);
  const std::vector<std::uint8_t>& load(std::size_t chunk);
  std::string read_bytes(std::uint64_t size);
  std::string describe(const std::string& fault) const;

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t file_bytes_ = 0;
  std::vector<Chunk> chunks_;
  std::map<std::uint32_t, std::string> connections_;  ///< topic by the connection's number
  std::map<std::string, BagTopic> topics_;
  std::vector<std::uint8_t> loaded_;
  std::size_t loaded_chunk_ = SIZE_MAX, num_messages_ = 0;
};

}  // namespace touchtrace
