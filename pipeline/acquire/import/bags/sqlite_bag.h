#pragma once

#include <filesystem>
#include <memory>

#include "pipeline/acquire/import/bags/message_file.h"

struct sqlite3;
struct sqlite3_stmt;

namespace touchtrace {

/// SQLite file (.db3) of rosbag2 with messages in CDR, also of messages that are compressed with
/// zstd one by one. Memory: one message. Safe for untrusted files.
class SqliteBag : public MessageFile {
 public:
  /// Throws data_error if the file is not a bag of ROS 2.
  explicit SqliteBag(std::filesystem::path file);

  ByteSpan read(const BagMessage& message) override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

  Statement prepare(const char* sql) const;
  /// Whether there is another row. Throws std::runtime_error if the database is damaged.
  bool step(const Statement& statement) const;
  void read_index();

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> database_;
  Statement select_;  ///< of one message
  std::vector<std::uint8_t> message_;
};

bool is_sqlite(const std::filesystem::path& file);

}  // namespace touchtrace
