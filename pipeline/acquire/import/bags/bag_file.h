#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/acquire/import/bags/message_file.h"

namespace touchtrace {

/// Bag of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0).
class BagFile : public ChunkedFile {
 public:
  /// Throws data_error if the file is not a bag or its chunks have an unknown compression. Reports
  /// a bag that ends early.
  explicit BagFile(const std::filesystem::path& file);

 private:
  using Fields = std::map<std::string, std::string>;

  std::uint64_t read_record(std::uint64_t position) override;
  std::uint32_t read_size(std::uint64_t position);
  void add_connection(const Fields& fields, const std::string& data);
  void index_chunk(std::size_t chunk);

  std::map<std::uint32_t, std::string> connections_;  ///< topic by the connection's number
};

}  // namespace touchtrace
