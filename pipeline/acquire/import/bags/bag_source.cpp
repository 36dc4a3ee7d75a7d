#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "calib/rgbd/foreign_calibration.h"
#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/import/bags/bag_file.h"
#include "pipeline/acquire/import/bags/ros_messages.h"
#include "pipeline/acquire/import/source/source.h"
#include "pipeline/acquire/time_order.h"

namespace touchtrace {
namespace {

constexpr const char* bag_magic = "#ROSBAG V";
constexpr const char* sdk_image = "/image/data";  // of librealsense's recorder

bool contains_any(const std::string& text, std::initializer_list<const char*> words) {
  return std::ranges::any_of(
      words, [&](const char* word) { return text.find(word) != std::string::npos; });
}

bool is_sdk_topic(const std::string& name) { return name.ends_with(sdk_image); }

bool is_registered_topic(const std::string& name) {
  return contains_any(name, {"aligned_depth_to_color", "depth_registered", "depth_to_rgb"});
}

/// Topic of images with its first image.
struct ImageTopic {
  std::string name;
  RosImage first;

  /// Smaller: more likely the one that is meant.
  int rank() const {
    int rank = contains_any(name, {"color", "rgb", "Color"}) ? 0 : 2;
    if (contains_any(name, {"infra", "/ir", "left", "right", "fisheye"})) rank = 4;
    if (first.is_depth()) rank = is_registered_topic(name) ? 0 : 2;
    return rank + first.is_compressed;
  }
};

std::vector<ImageTopic> find_image_topics(MessageFile& bag) {
  std::vector<ImageTopic> topics;
  for (const auto& [name, topic] : bag.topics()) {
    if (!is_image_type(topic.type) || topic.messages.empty()) continue;
    ImageTopic found{
        name, parse_image(bag.read(topic.messages.front()), topic.type, topic.serialization)};
    found.first.data = {};
    topics.push_back(std::move(found));
  }
  std::ranges::stable_sort(topics, {}, &ImageTopic::rank);
  return topics;
}

const ImageTopic& choose_topic(const std::vector<ImageTopic>& topics, const std::string& wanted,
                               bool is_depth) {
  const auto found = std::ranges::find_if(topics, [&](const ImageTopic& topic) {
    return topic.first.is_depth() == is_depth && (wanted.empty() || topic.name == wanted);
  });
  const char* kind = is_depth ? "depth" : "color";
  if (found == topics.end()) {
    std::vector<std::string> names;
    for (const ImageTopic& topic : topics)
      names.push_back(fmt::format("{} ({})", topic.name, topic.first.encoding));
    throw data_error(
        wanted.empty() ? fmt::format("the bag has no {} images", kind)
                       : fmt::format("the bag has no {} images of topic {}", kind, wanted),
        names.empty() ? "give a bag with topics of type sensor_msgs/Image or CompressedImage"
                      : fmt::format("--{}-topic chooses one of: {}", kind, comma_separated(names)));
  }
  Progress::report(fmt::format("{} topic: {}", kind, found->name));
  return *found;
}

SourceStream open_stream(const std::shared_ptr<MessageFile>& bag, const std::string& name) {
  const BagTopic& topic = bag->topics().at(name);
  SourceStream stream;
  std::vector<BagMessage> messages;
  for (const BagMessage& message : in_time_order(topic.messages, &BagMessage::record_time_s, name))
    try {
      const std::string image = fmt::format("message {} of {}", messages.size(), name);
      const double device_time_s =
          parse_image(bag->read(message), topic.type, topic.serialization).stamp_s;
      stream.images.push_back({image, message.record_time_s, device_time_s});
      messages.push_back(message);
    } catch (const std::out_of_range& error) {
      Progress::warn(fmt::format("skipped a message of {}: {}", name, error.what()));
    }
  stream.read = [bag, messages = std::move(messages), type = topic.type,
                 serialization = topic.serialization](std::size_t i) {
    return decode(parse_image(bag->read(messages[i]), type, serialization));
  };
  return stream;
}

/// Topic of the CameraInfo that belongs to a topic of images.
std::string info_topic(std::string name) {
  if (is_sdk_topic(name)) return name.replace(name.rfind(sdk_image), 11, "/info/camera_info");
  for (const std::string suffix : {"/compressed", "/compressedDepth"})
    if (name.ends_with(suffix)) name.erase(name.size() - suffix.size());
  return name.substr(0, name.rfind('/')) + "/camera_info";
}

std::optional<Camera> camera_of(MessageFile& bag, const std::string& image_topic) {
  const auto topic = bag.topics().find(info_topic(image_topic));
  if (topic == bag.topics().end() || topic->second.messages.empty()) return std::nullopt;
  try {
    return camera_from_info(
        parse_camera_info(bag.read(topic->second.messages.front()), topic->second.serialization));
  } catch (const std::exception& error) {
    Progress::warn(fmt::format("{} is not used: {}", topic->first, error.what()));
    return std::nullopt;
  }
}

/// Counts per metre as the recorder of librealsense states them; ROS has millimetres.
double counts_per_m(MessageFile& bag) {
  for (const auto& [name, topic] : bag.topics()) {
    if (!name.ends_with("/option/Depth Units/value") || topic.messages.empty()) continue;
    const float unit_m = parse_float32(bag.read(topic.messages.front()));
    if (unit_m > 1e-6f && unit_m < 1.0f) return 1.0 / unit_m;
  }
  return 1000.0;
}

/// Names of frames in files of librealsense's recorder mean nothing.
bool is_registered(const ImageTopic& color, const ImageTopic& depth) {
  return is_registered_topic(depth.name) ||
         (!is_sdk_topic(depth.name) && depth.first.frame_id == color.first.frame_id);
}

}  // namespace

bool is_bag(const std::filesystem::path& file) { return begins_with(file, bag_magic); }

ImportSource open_bag_source(const std::filesystem::path& file, const SourceOptions& options) {
  return open_messages(std::make_shared<BagFile>(file), options);
}

ImportSource open_messages(const std::shared_ptr<MessageFile>& bag, const SourceOptions& options) {
  const auto topics = find_image_topics(*bag);
  const ImageTopic& color = choose_topic(topics, options.color_topic, false);
  const ImageTopic& depth = choose_topic(topics, options.depth_topic, true);
  ImportSource source{.color = open_stream(bag, color.name),
                      .depth = open_stream(bag, depth.name),
                      .counts_per_m = counts_per_m(*bag),
                      .is_registered = is_registered(color, depth)};
  source.color.camera = camera_of(*bag, color.name);
  source.depth.camera = camera_of(*bag, depth.name);
  return source;
}

}  // namespace touchtrace
