#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/export/mcap_writer.h"
#include "pipeline/export/message_streams.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Message that is not made yet.
struct PendingMessage {
  std::int64_t time_ns;
  std::size_t stream, index;
};

/// Unix time. Without it, stamps before the host clock's 0 would be negative, which MCAP does not
/// have; the clock is then shifted by whole seconds.
double first_epoch_s(const MessageStreams& all) {
  double first_s = 0.0;
  for (const MessageStream& stream : all.streams)
    first_s = std::min(first_s, stream.time_s.front());
  const double shift_s = std::ceil(-first_s);
  if (shift_s > all.epoch_unix_s)
    Progress::warn(
        fmt::format("the first stamp is {:.6f} s, and stamps before 0 cannot be written: all are "
                    "{:.0f} s later",
                    first_s, shift_s - all.epoch_unix_s));
  return std::max(all.epoch_unix_s, shift_s);
}

/// All messages in order of their times.
std::vector<PendingMessage> sorted_messages(const MessageStreams& all) {
  const double epoch_s = first_epoch_s(all), whole_s = std::floor(epoch_s);
  std::vector<PendingMessage> messages;
  for (std::size_t s = 0; s < all.streams.size(); ++s)
    for (std::size_t i = 0; i < all.streams[s].time_s.size(); ++i) {
      // A double resolves Unix time to 0.2 us only, so whole seconds are added as integers.
      const double rest_s = epoch_s - whole_s + all.streams[s].time_s[i];
      messages.push_back({static_cast<std::int64_t>(whole_s) * 1'000'000'000 +
                              static_cast<std::int64_t>(std::llround(1e9 * rest_s)),
                          s, i});
    }
  std::ranges::stable_sort(messages, {}, &PendingMessage::time_ns);
  return messages;
}

std::vector<std::uint16_t> add_channels(McapWriter& mcap, const MessageStreams& all) {
  std::map<const RosType*, std::uint16_t> schemas;
  std::vector<std::uint16_t> channels;
  for (const MessageStream& stream : all.streams) {
    if (!schemas.contains(stream.type))
      schemas[stream.type] = mcap.add_schema(stream.type->name, "ros2msg", stream.type->definition);
    channels.push_back(mcap.add_channel(schemas.at(stream.type), stream.topic, "cdr"));
  }
  return channels;
}

void write_messages(McapWriter& mcap, const MessageStreams& all) {
  const auto channels = add_channels(mcap, all);
  const auto messages = sorted_messages(all);
  Progress progress("writing messages", messages.size());
  for (const PendingMessage& next : messages) {
    throw_if_interrupted();
    const MessageStream& stream = all.streams[next.stream];
    mcap.write(channels[next.stream], static_cast<std::uint64_t>(next.time_ns),
               stream.message({next.time_ns, stream.frame_id}, next.index));
    progress.advance();
  }
  mcap.finish();
}

/// metadata.yaml of a rosbag2 with one file (rosbag2_storage, version 5).
std::string rosbag2_metadata(const McapWriter& mcap, const std::string& file) {
  const std::uint64_t duration_ns = mcap.end_ns() - mcap.start_ns();
  std::string text = fmt::format(
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
      "  duration:\n    nanoseconds: {0}\n  starting_time:\n    nanoseconds_since_epoch: {1}\n"
      "  message_count: {2}\n  topics_with_message_count:\n",
      duration_ns, mcap.start_ns(), mcap.messages());
  for (const auto& channel : mcap.channels())
    text += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n"
        "        serialization_format: cdr\n        offered_qos_profiles: \"\"\n"
        "      message_count: {}\n",
        channel.topic, channel.type, channel.messages);
  return text + fmt::format(
                    "  compression_format: \"\"\n  compression_mode: \"\"\n"
                    "  relative_file_paths:\n    - {0}\n  files:\n    - path: {0}\n"
                    "      starting_time:\n        nanoseconds_since_epoch: {1}\n"
                    "      duration:\n        nanoseconds: {2}\n      message_count: {3}\n",
                    file, mcap.start_ns(), duration_ns, mcap.messages());
}

}  // namespace

std::vector<fs::path> write_mcap(const ExportRequest& request) {
  OutputFile output(request.output, request.overwrite);
  McapWriter mcap(output.temporary(), "ros2");
  write_messages(mcap, open_streams(request));
  output.commit();
  return {request.output};
}

std::vector<fs::path> write_rosbag2(const ExportRequest& request) {
  // The name of the file must not depend on how the folder is written: "bag", "bag/".
  const std::string name = "messages.mcap";
  OutputFile output(request.output / name, request.overwrite),
      metadata(request.output / "metadata.yaml", request.overwrite);
  McapWriter mcap(output.temporary(), "ros2");
  write_messages(mcap, open_streams(request));
  output.commit();
  write_file(metadata.path(), rosbag2_metadata(mcap, name), request.overwrite);
  return {output.path(), metadata.path()};
}

}  // namespace touchtrace
