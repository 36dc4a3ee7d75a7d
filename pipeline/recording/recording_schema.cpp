#include "pipeline/recording/recording_schema.h"

#include <fmt/core.h>

#include <climits>
#include <cmath>

#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr h5::DatasetInfo clip_start{"s", "start of the clip, host clock"};

void append(std::vector<std::int32_t>& column, const PixelBox& box) {
  column.insert(column.end(), {box.x, box.y, box.width, box.height});
}

PixelBox box_at(const std::vector<std::int32_t>& column, std::size_t i) {
  return {column[4 * i], column[4 * i + 1], column[4 * i + 2], column[4 * i + 3]};
}

}  // namespace

ClipColumns to_columns(const std::vector<Clip>& clips) {
  ClipColumns columns;
  for (const auto& clip : clips) {
    columns.start_s.push_back(clip.start_s);
    columns.end_s.push_back(clip.end_s);
    columns.object.push_back(clip.object);
    columns.object_fell.push_back(clip.object_fell ? 1 : 0);
    append(columns.hand_box, clip.hand_box);
    append(columns.object_box, clip.object_box);
    columns.box_frame.push_back(clip.box_frame ? static_cast<std::int64_t>(*clip.box_frame) : -1);
  }
  return columns;
}

EventColumns to_columns(const std::vector<Truth::Event>& events) {
  EventColumns columns;
  for (const auto& event : events) {
    columns.time_s.push_back(event.time_s);
    columns.kind.push_back(event.kind);
  }
  return columns;
}

h5::Axis clip_axis(h5::Saver& group, const ClipColumns& columns) {
  return group.axis("start_s", columns.start_s, clip_start);
}

h5::Axis clip_axis(const h5::Loader& group, ClipColumns& columns) {
  if (group.has("start_s")) return group.axis("start_s", columns.start_s, clip_start);
  for (const char* name : {"end_s", "object", "dropped", "hand_box", "object_box", "box_frame"})
    if (const auto shape = group.shape(name); !shape.empty()) return {name, shape[0]};
  return {"start_s", 1};
}

std::vector<Clip> read_clips(const h5::Loader& root, const std::optional<Clip>& whole) {
  if (!root.has("clips")) return whole ? std::vector{*whole} : std::vector<Clip>{};
  ClipColumns c;
  const h5::Loader group = root.group("clips");
  const h5::Axis axis = serialize_clips(group, c);
  if (root.faults().contains(group.path())) return {};
  std::vector<Clip> clips(axis.length, whole.value_or(Clip{}));
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!c.start_s.empty()) clips[i].start_s = c.start_s[i];
    if (!c.end_s.empty()) clips[i].end_s = c.end_s[i];
    if (!c.object.empty()) clips[i].object = c.object[i];
    if (!c.object_fell.empty()) clips[i].object_fell = c.object_fell[i] != 0;
    if (!c.hand_box.empty()) clips[i].hand_box = box_at(c.hand_box, i);
    if (!c.object_box.empty()) clips[i].object_box = box_at(c.object_box, i);
    if (c.box_frame.empty() || c.box_frame[i] == -1) continue;
    root.faults().require(
        c.box_frame[i] >= 0, group.path("box_frame"),
        fmt::format("expected -1 or the index of a colour image, found {}", c.box_frame[i]));
    clips[i].box_frame = static_cast<std::size_t>(c.box_frame[i]);
  }
  return clips;
}

GloveStream read_glove(const h5::Loader& group) {
  GloveStream glove;
  GloveInfo& info = glove.info;
  info.bits = 16;
  const auto shape = group.shape("counts");
  const auto extent = [&](std::size_t axis) {
    return shape.size() == 3 && shape[axis] <= INT_MAX ? static_cast<int>(shape[axis]) : -1;
  };
  info.rows = extent(1), info.cols = extent(2);
  serialize_glove(group, glove);
  if (group.faults().contains(group.path())) return glove;
  const auto taxels = static_cast<std::size_t>(info.rows) * static_cast<std::size_t>(info.cols);
  if (!group.has_attribute("rate_hz")) info.rate_hz = rate_of(glove.host_time_s, info.rate_hz);
  fill_sequence(glove.sequence, glove.host_time_s, info.rate_hz);
  if (info.baseline_counts.empty()) info.baseline_counts.assign(taxels, 0.0f);
  if (info.mask.empty()) info.mask.assign(taxels, 1);
  if (info.taxel_position_m.empty()) info.taxel_position_m.assign(3 * taxels, std::nanf(""));
  return glove;
}

Provenance read_provenance(const h5::Loader& root) {
  nlohmann::json json;
  root.optional_attribute("provenance", json);
  if (json.is_null()) return {};
  try {
    nlohmann::json whole = Provenance{};
    whole.update(json);
    return whole.get<Provenance>();
  } catch (const nlohmann::json::exception& fault) {
    root.faults().add(attribute_path(root.path(), "provenance"), fault.what());
    return {};
  }
}

Truth read_truth_group(const h5::Loader& root) {
  Truth truth;
  EventColumns events;
  const h5::Loader group = root.group("truth");
  serialize_truth(group, truth, events);
  if (root.faults().contains(group.path("events"))) return truth;
  for (std::size_t i = 0; i < events.time_s.size(); ++i)
    truth.events.push_back({events.time_s[i], events.kind[i]});
  return truth;
}

}  // namespace touchtrace
