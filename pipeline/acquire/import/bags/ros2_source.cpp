#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/import/bags/mcap_file.h"
#include "pipeline/acquire/import/bags/sqlite_bag.h"
#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr const char* metadata_name = "metadata.yaml";
constexpr std::uintmax_t max_metadata_bytes = 16u << 20;

/// Files of a bag that was split, as one. Messages are numbered by their file in `chunk`.
class SplitBag : public MessageFile {
 public:
  explicit SplitBag(std::vector<std::unique_ptr<MessageFile>> files) : files_(std::move(files)) {
    for (std::size_t i = 0; i < files_.size(); ++i)
      for (const auto& [name, topic] : files_[i]->topics()) add(name, topic, i);
  }

  ByteSpan read(const BagMessage& message) override {
    const auto& [file, own] = messages_.at(message.offset);
    return files_[file]->read(own);
  }

 private:
  void add(const std::string& name, const BagTopic& topic, std::size_t file) {
    topics_[name].type = topic.type;
    topics_[name].serialization = topic.serialization;
    for (const BagMessage& message : topic.messages) {
      topics_[name].messages.push_back(
          {.record_time_s = message.record_time_s, .offset = messages_.size()});
      messages_.emplace_back(file, message);
    }
  }

  std::vector<std::unique_ptr<MessageFile>> files_;
  std::vector<std::pair<std::size_t, BagMessage>> messages_;  ///< with their file
};

bool is_bag_file(const fs::path& file) { return is_sqlite(file) || is_mcap(file); }

std::unique_ptr<MessageFile> open_file(const fs::path& file) {
  if (is_mcap(file)) return std::make_unique<McapFile>(file);
  return std::make_unique<SqliteBag>(file);
}

/// Files of a bag's folder, in order of their names.
std::vector<fs::path> bag_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_bag_file(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

bool is_bag_folder(const fs::path& path) {
  return fs::is_regular_file(path / metadata_name) &&
         read_file(path / metadata_name, max_metadata_bytes).find("rosbag2_bagfile_information") !=
             std::string::npos;
}

}  // namespace

bool is_ros2_bag(const fs::path& path) {
  if (fs::is_directory(path)) return is_bag_folder(path) || !bag_files(path).empty();
  return is_bag_file(path);
}

ImportSource open_ros2_bag(const fs::path& path, const SourceOptions& options) {
  if (!fs::is_directory(path)) return open_messages(open_file(path), options);
  std::vector<std::unique_ptr<MessageFile>> files;
  for (const fs::path& file : bag_files(path)) files.push_back(open_file(file));
  if (files.empty())
    throw data_error(path.string() + " has no .db3 or .mcap file",
                     "decompress the files of a bag in mode FILE: zstd -d *.zstd");
  return open_messages(std::make_shared<SplitBag>(std::move(files)), options);
}

}  // namespace touchtrace
