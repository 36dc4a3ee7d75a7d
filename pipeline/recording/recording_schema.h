#pragma once

#include <array>
#include <type_traits>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

inline constexpr const char* recording_schema = "touchtrace/recording/1";
inline constexpr const char* labels_schema = "touchtrace/labels/1";
inline constexpr std::size_t most_gloves = 2;

inline std::string glove_group(std::size_t index) { return "glove" + std::to_string(index); }

/// Clips as columns, the way they are stored.
struct ClipColumns {
  std::vector<double> start_s, end_s;
  std::vector<std::string> object;
  std::vector<std::uint8_t> dropped;
  std::vector<std::int32_t> hand_box, object_box;  ///< [n, 4]: x, y, width, height
};

ClipColumns columns_of(const std::vector<Clip>& clips);
std::vector<Clip> clips_of(const ClipColumns& columns);

/// Events of the truth as columns.
struct EventColumns {
  std::vector<double> time_s;
  std::vector<std::string> kind;
};

EventColumns columns_of(const std::vector<Truth::Event>& events);
std::vector<Truth::Event> events_of(const EventColumns& columns);

/// What recordings and labels both have at their root.
std::vector<Clip> read_clips(const h5::Loader& root);
Provenance read_provenance(const h5::Loader& root);

// Each `exchange(archive, value)` is the one description of how a struct lies in a group: an
// h5::Saver writes it from a const value, an h5::Loader fills and checks it.

template <class Archive, class Columns>
void exchange_clips(Archive& group, Columns& c) {
  const h5::Axis clip = group.axis("start_s", c.start_s, {"s", "start of the clip, host clock"});
  const h5::Axis corner = group.axis("corner", 4);
  group.array("end_s", c.end_s, {clip}, {"s", "end of the clip, host clock"});
  group.texts("object", c.object, clip, {"1", "name of the object"});
  group.array("dropped", c.dropped, {clip}, {"1", "1 where the object fell"});
  group.array("hand_box", c.hand_box, {clip, corner},
              {"1", "x, y, width, height in the colour image"});
  group.array("object_box", c.object_box, {clip, corner},
              {"1", "x, y, width, height in the colour image"});
}

template <class Archive, class Info>
void exchange_glove_info(Archive& group, Info& info) {
  group.attribute("name", info.name);
  group.attribute("rows", info.rows);
  group.attribute("cols", info.cols);
  group.attribute("rate_hz", info.rate_hz);
  group.attribute("scan_s", info.scan_s);
  group.attribute("bits", info.bits);
  group.attribute("polarity", info.polarity);
}

template <class Archive, class Numbers>
void exchange_numbers(Archive& group, const std::string& name, Numbers& numbers,
                      const h5::Axis& axis, const h5::Meaning& meaning) {
  std::vector<double> values(numbers.begin(), numbers.end());
  group.array(name, values, {axis}, meaning);
  if constexpr (!std::is_const_v<Numbers>)
    std::copy_n(values.begin(), numbers.size(), numbers.begin());
}

template <class Archive, class Stream>
void exchange_inertial(Archive& group, Stream& stream) {
  group.attribute("rate_hz", stream.rate_hz);
  const h5::Axis sample =
      group.axis("host_time_s", stream.host_time_s, {"s", "arrival, host clock"});
  const h5::Axis xyz = group.axis("xyz", 3), wxyz = group.axis("wxyz", 4);
  exchange_numbers(group, "place", stream.place_m, xyz, {"m", "of the unit, hand's frame"});
  group.array("sequence", stream.sequence, {sample}, {"1", "the unit's own sample counter"});
  group.array("specific_force", stream.specific_force_m_per_s2, {sample, xyz},
              {"m s-2", "acceleration less gravity's, hand's frame"});
  group.array("angular_velocity", stream.angular_velocity_rad_per_s, {sample, xyz},
              {"rad s-1", "hand's frame"});
  group.array("orientation_wxyz", stream.orientation_wxyz, {sample, wxyz},
              {"1", "unit quaternion, the unit's own estimate, of the hand in a frame with z up"});
}

template <class Archive, class Stream>
void exchange_glove(Archive& group, Stream& stream) {
  exchange_glove_info(group, stream.info);
  const h5::Axis row = group.axis("row", static_cast<std::size_t>(stream.info.rows));
  const h5::Axis col = group.axis("col", static_cast<std::size_t>(stream.info.cols));
  const h5::Axis xyz = group.axis("xyz", 3);
  const h5::Axis frame =
      group.axis("host_time_s", stream.host_time_s, {"s", "arrival, host clock"});
  group.array("sequence", stream.sequence, {frame}, {"1", "the glove's own frame counter"});
  group.array("counts", stream.counts, {frame, row, col}, {"1", "converter counts"});
  group.array("baseline", stream.info.baseline_counts, {row, col}, {"1", "counts, untouched"});
  group.array("mask", stream.info.mask, {row, col}, {"1", "1 where there is a taxel"});
  group.array("taxel_position", stream.info.taxel_position_m, {row, col, xyz},
              {"m", "place of the taxel in the hand's frame"});
  if constexpr (!std::is_const_v<Stream>)
    if (group.has("inertial")) stream.inertial.emplace();
  if (!stream.inertial) return;
  auto inertial = group.group("inertial");
  exchange_inertial(inertial, *stream.inertial);
}

template <class Archive, class Camera>
void exchange_camera_info(Archive& group, Camera& camera) {
  group.attribute("width", camera.width);
  group.attribute("height", camera.height);
  group.attribute("rate_hz", camera.rate_hz);
  group.attribute("depth_unit_m", camera.depth_unit_m);
  exchange_numbers(group, "gravity", camera.gravity, group.axis("xyz", 3),
                   {"m s-2", "colour camera's frame"});
  exchange_numbers(group, "depth_intrinsics", camera.depth_intrinsics, group.axis("fx_fy_cx_cy", 4),
                   {"1", "of the depth camera as its driver reports them, in pixels; 0: unknown"});
}

/// Returns the axis of the frames.
template <class Archive, class Times>
h5::Axis exchange_camera_times(Archive& group, Times& times) {
  const h5::Axis frame = group.axis("host_time_s", times.host_time_s, {"s", "arrival, host clock"});
  group.array("device_time_s", times.device_time_s, {frame}, {"s", "the camera's own clock"});
  group.array("sequence", times.sequence, {frame}, {"1", "the camera's own frame counter"});
  return frame;
}

template <class Archive, class Board>
void exchange_board(Archive& group, Board& board) {
  group.attribute("columns", board.columns);
  group.attribute("rows", board.rows);
  group.attribute("square_m", board.square_m);
}

template <class Archive, class Body>
void exchange_true_body(Archive& group, Body& body, const h5::Axis& sample) {
  const h5::Axis xyz = group.axis("xyz", 3), wxyz = group.axis("wxyz", 4);
  group.array("position_m", body.position_m, {sample, xyz},
              {"m", "position, colour camera's frame"});
  group.array("velocity_m_per_s", body.velocity_m_per_s, {sample, xyz}, {"m s-1", "velocity"});
  group.array("orientation_wxyz", body.orientation_wxyz, {sample, wxyz}, {"1", "unit quaternion"});
}

template <class Archive, class True, class Events>
void exchange_truth(Archive& group, True& truth, Events& events) {
  group.attribute("calibration", truth.calibration);
  group.attribute("clocks", truth.clocks);
  const h5::Axis sample = group.axis("time_s", truth.time_s, {"s", "host clock"});
  group.array("clip", truth.clip, {sample}, {"1", "number of the clip"});
  group.array("contact_force_n", truth.contact_force_n, {sample, group.axis("xyz", 3)},
              {"N", "force of the hand on the object, colour camera's frame"});
  auto hand = group.group("hand"), object = group.group("object"), event = group.group("events");
  exchange_true_body(hand, truth.hand, sample);
  exchange_true_body(object, truth.object, sample);
  const h5::Axis at = event.axis("time_s", events.time_s, {"s", "host clock"});
  event.texts("kind", events.kind, at, {"1", "what happened"});
}

}  // namespace touchtrace
