#pragma once

#include <algorithm>
#include <type_traits>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

inline constexpr const char* recording_schema = "touchtrace/recording/2";
inline constexpr const char* recording_schema_1 = "touchtrace/recording/1";  ///< still read
inline constexpr const char* labels_schema = "touchtrace/labels/1";
inline constexpr std::size_t max_gloves = 2;

inline std::string glove_group(std::size_t index) { return "glove" + std::to_string(index); }

/// Clips in the layout of the file: one array per member.
struct ClipColumns {
  std::vector<double> start_s, end_s;
  std::vector<std::string> object;
  std::vector<std::uint8_t> object_fell;
  std::vector<std::int32_t> hand_box, object_box;  ///< [n, 4]: x, y, width, height
  std::vector<std::int64_t> box_frame;  ///< colour image of the boxes; -1: the clip's first
};

ClipColumns to_columns(const std::vector<Clip>& clips);
h5::Axis clip_axis(h5::Saver& group, const ClipColumns& columns);
/// Number of clips by the first column that exists.
h5::Axis clip_axis(const h5::Loader& group, ClipColumns& columns);

/// Truth events in the layout of the file.
struct EventColumns {
  std::vector<double> time_s;
  std::vector<std::string> kind;
};

EventColumns to_columns(const std::vector<Truth::Event>& events);

/// Parts that recordings and labels share. Empty if they have a fault. `whole`: the only clip if
/// the file has none, and default of members that are missing.
std::vector<Clip> read_clips(const h5::Loader& root, const std::optional<Clip>& whole);
Provenance read_provenance(const h5::Loader& root);
GloveStream read_glove(const h5::Loader& group);
Truth read_truth_group(const h5::Loader& root);

// Layout of the file. Each template is used with an h5::Saver and a const value to write, and with
// an h5::Loader to read and check. pipeline/recording/README.md documents the layout for users.

/// Returns the clip axis.
template <class Archive, class Columns>
h5::Axis serialize_clips(Archive& group, Columns& c) {
  const h5::Axis clip = clip_axis(group, c);
  const h5::Axis corner = group.axis("corner", 4);
  group.optional_array("end_s", c.end_s, {clip}, {"s", "end of the clip, host clock"});
  group.optional_texts("object", c.object, clip, {"1", "object name"});
  group.optional_array("dropped", c.object_fell, {clip}, {"1", "1: the object fell"});
  group.optional_array("hand_box", c.hand_box, {clip, corner},
                       {"1", "x, y, width, height in the colour image, pixels"});
  group.optional_array("object_box", c.object_box, {clip, corner},
                       {"1", "x, y, width, height in the colour image, pixels"});
  group.optional_array("box_frame", c.box_frame, {clip},
                       {"1", "index of the colour image of the boxes, -1: first of the clip"});
  return clip;
}

template <class Archive, class Info>
void serialize_glove_info(Archive& group, Info& info) {
  group.optional_attribute("name", info.name);
  group.optional_attribute("rows", info.rows);
  group.optional_attribute("cols", info.cols);
  group.optional_attribute("rate_hz", info.rate_hz);
  group.optional_attribute("scan_s", info.scan_s);
  group.optional_attribute("bits", info.bits);
  group.optional_attribute("polarity", info.polarity);
}

/// Length of an axis; unknown for a faulty attribute.
inline std::size_t axis_length(int length) {
  return length > 0 ? static_cast<std::size_t>(length) : h5::unknown_length;
}

/// A std::array of doubles.
template <class Archive, class Numbers>
void serialize_numbers(Archive& group, const std::string& name, Numbers& numbers,
                       const h5::Axis& axis, const h5::DatasetInfo& info) {
  std::vector<double> values(numbers.begin(), numbers.end());
  group.array(name, values, {axis}, info);
  if constexpr (!std::is_const_v<Numbers>)
    std::copy_n(values.begin(), std::min(values.size(), numbers.size()), numbers.begin());
}

template <class Archive, class Stream>
void serialize_inertial(Archive& group, Stream& stream) {
  group.attribute("rate_hz", stream.rate_hz);
  const h5::Axis sample =
      group.axis("host_time_s", stream.host_time_s, {"s", "arrival, host clock"});
  const h5::Axis xyz = group.axis("xyz", 3), wxyz = group.axis("wxyz", 4);
  serialize_numbers(group, "place", stream.position_m, xyz,
                    {"m", "position of the unit, hand's frame"});
  group.array("sequence", stream.sequence, {sample}, {"1", "sample counter of the unit"});
  group.array("specific_force", stream.specific_force_m_per_s2, {sample, xyz},
              {"m s-2", "acceleration minus gravity, hand's frame"});
  group.array("angular_velocity", stream.angular_velocity_rad_per_s, {sample, xyz},
              {"rad s-1", "angular velocity, hand's frame"});
  group.array(
      "orientation_wxyz", stream.orientation_wxyz, {sample, wxyz},
      {"1", "unit quaternion, the unit's estimate, from the hand's frame to one with z up"});
}

template <class Archive, class Stream>
void serialize_glove(Archive& group, Stream& stream) {
  serialize_glove_info(group, stream.info);
  const h5::Axis row = group.axis("row", axis_length(stream.info.rows));
  const h5::Axis col = group.axis("col", axis_length(stream.info.cols));
  const h5::Axis xyz = group.axis("xyz", 3);
  const h5::Axis frame =
      group.axis("host_time_s", stream.host_time_s, {"s", "arrival, host clock"});
  group.optional_array("sequence", stream.sequence, {frame}, {"1", "frame counter of the glove"});
  group.array("counts", stream.counts, {frame, row, col},
              {"1", "counts of the analog-to-digital converter"});
  group.optional_array("baseline", stream.info.baseline_counts, {row, col},
                       {"1", "counts without contact"});
  group.optional_array("mask", stream.info.mask, {row, col}, {"1", "1: taxel exists"});
  group.optional_array("taxel_position", stream.info.taxel_position_m, {row, col, xyz},
                       {"m", "position of the taxel, hand's frame; NaN: unknown"});
  if constexpr (!std::is_const_v<Stream>)
    if (group.has("inertial")) stream.inertial.emplace();
  if (!stream.inertial) return;
  auto inertial = group.group("inertial");
  serialize_inertial(inertial, *stream.inertial);
}

template <class Archive, class Board>
void serialize_board(Archive& group, Board& board) {
  group.attribute("columns", board.columns);
  group.attribute("rows", board.rows);
  group.attribute("square_m", board.square_m);
}

template <class Archive, class Body>
void serialize_true_body(Archive& group, Body& body, const h5::Axis& sample) {
  const h5::Axis xyz = group.axis("xyz", 3), wxyz = group.axis("wxyz", 4);
  group.array("position_m", body.position_m, {sample, xyz},
              {"m", "position, colour camera's frame"});
  group.array("velocity_m_per_s", body.velocity_m_per_s, {sample, xyz},
              {"m s-1", "velocity, colour camera's frame"});
  group.array("orientation_wxyz", body.orientation_wxyz, {sample, wxyz}, {"1", "unit quaternion"});
}

template <class Archive, class True, class Events>
void serialize_truth(Archive& group, True& truth, Events& events) {
  group.attribute("calibration", truth.calibration);
  group.attribute("clocks", truth.clocks);
  const h5::Axis sample = group.axis("time_s", truth.time_s, {"s", "host clock"});
  group.array("clip", truth.clip, {sample}, {"1", "index of the clip"});
  group.array("contact_force_n", truth.contact_force_n, {sample, group.axis("xyz", 3)},
              {"N", "force of the hand on the object, colour camera's frame"});
  auto hand = group.group("hand"), object = group.group("object"), event = group.group("events");
  serialize_true_body(hand, truth.hand, sample);
  serialize_true_body(object, truth.object, sample);
  const h5::Axis at = event.axis("time_s", events.time_s, {"s", "host clock"});
  event.texts("kind", events.kind, at, {"1", "release, catch, impact or drop"});
}

}  // namespace touchtrace
