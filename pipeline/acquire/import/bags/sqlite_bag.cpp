#include "pipeline/acquire/import/bags/sqlite_bag.h"

#include <fmt/core.h>
#include <sqlite3.h>

#include <stdexcept>

#include "engine/base/error.h"
#include "pipeline/acquire/import/bags/mcap_file.h"

namespace touchtrace {
namespace {

constexpr std::string_view sqlite_magic{"SQLite format 3\0", 16};
constexpr int max_blob_bytes = 256 << 20;

std::string text_of(sqlite3_stmt* statement, int column) {
  const auto* text = sqlite3_column_text(statement, column);
  return text ? std::string(reinterpret_cast<const char*>(text),
                            static_cast<std::size_t>(sqlite3_column_bytes(statement, column)))
              : std::string();
}

}  // namespace

bool is_sqlite(const std::filesystem::path& file) { return begins_with(file, sqlite_magic); }

void SqliteBag::Close::operator()(sqlite3* database) const { sqlite3_close(database); }

void SqliteBag::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

SqliteBag::SqliteBag(std::filesystem::path file) : file_(std::move(file)) {
  try {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(file_.c_str(), &opened,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) throw std::runtime_error(sqlite3_errstr(result));
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, max_blob_bytes);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    read_index();
    select_ = prepare("SELECT data FROM messages WHERE id = ?");
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read {}: {}", file_.string(), error.what()),
                     "give the .db3 file of a complete bag of ROS 2");
  }
}

SqliteBag::Statement SqliteBag::prepare(const char* sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK)
    throw std::runtime_error(sqlite3_errmsg(database_.get()));
  return Statement(statement);
}

bool SqliteBag::step(const Statement& statement) const {
  const int result = sqlite3_step(statement.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE)
    throw std::runtime_error(sqlite3_errmsg(database_.get()));
  return result == SQLITE_ROW;
}

void SqliteBag::read_index() {
  std::map<sqlite3_int64, BagTopic*> by_number;
  const auto topics = prepare("SELECT id, name, type, serialization_format FROM topics");
  while (step(topics)) {
    if (text_of(topics.get(), 3) != "cdr") continue;
    BagTopic& topic = topics_[text_of(topics.get(), 1)];
    topic.type = ros_type(text_of(topics.get(), 2));
    topic.serialization = RosSerialization::cdr;
    by_number[sqlite3_column_int64(topics.get(), 0)] = &topic;
  }
  const auto messages = prepare("SELECT id, topic_id, timestamp FROM messages ORDER BY id");
  for (std::size_t count = 0; step(messages); ++count) {
    if (count == max_messages) throw std::runtime_error("it has too many messages");
    const auto topic = by_number.find(sqlite3_column_int64(messages.get(), 1));
    if (topic == by_number.end()) continue;
    const auto time_ns = static_cast<double>(sqlite3_column_int64(messages.get(), 2));
    const auto number = static_cast<std::size_t>(sqlite3_column_int64(messages.get(), 0));
    topic->second->messages.push_back({.record_time_s = 1e-9 * time_ns, .offset = number});
  }
}

ByteSpan SqliteBag::read(const BagMessage& message) {
  sqlite3_reset(select_.get());
  sqlite3_bind_int64(select_.get(), 1, static_cast<sqlite3_int64>(message.offset));
  if (!step(select_)) throw std::out_of_range("a message is missing");
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(select_.get(), 0));
  const ByteSpan stored(
      data, data ? static_cast<std::size_t>(sqlite3_column_bytes(select_.get(), 0)) : 0);
  return plain_message(stored, message_);
}

}  // namespace touchtrace
