#pragma once

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_schema.h"

namespace touchtrace {

template <class Archive, class Body>
void serialize_labelled_body(Archive& group, Body& body, const h5::Axis& label) {
  const h5::Axis xyz = group.axis("xyz", 3), i = group.axis("state_i", 6),
                 j = group.axis("state_j", 6);
  group.array("position_m", body.position_m, {label, xyz},
              {"m", "smoothed position, colour camera's frame"});
  group.array("velocity_m_per_s", body.velocity_m_per_s, {label, xyz},
              {"m s-1", "smoothed velocity, colour camera's frame"});
  group.array("covariance", body.covariance, {label, i, j},
              {"1", "covariance of smoothed (position in m, velocity in m s-1)"});
  group.array("causal_position_m", body.causal_position_m, {label, xyz},
              {"m", "filtered position, uses no later measurements"});
  group.array("causal_velocity_m_per_s", body.causal_velocity_m_per_s, {label, xyz},
              {"m s-1", "filtered velocity, uses no later measurements"});
  group.array("quality", body.quality, {label},
              {"1", "0: good; bits: 1 lost, 2 follows the hand, 4 outside the measured time"});
  if constexpr (std::is_const_v<Body>) {
    if (body.error_budget_m.empty()) return;
  } else if (!group.has("error_budget_m")) {
    return;
  }
  group.array(
      "error_budget_m", body.error_budget_m, {label, group.axis("source", 5)},
      {"m", "standard deviation of the position by source, see `error_sources` in summary"});
}

template <class Archive, class Raw>
void serialize_raw(Archive& group, Raw& raw) {
  const h5::Axis frame = group.axis("time_s", raw.time_s, {"s", "host clock"});
  const h5::Axis xyz = group.axis("xyz", 3);
  group.array("clip", raw.clip, {frame}, {"1", "index of the clip"});
  group.array("hand_m", raw.hand_m, {frame, xyz}, {"m", "measured position, NaN: lost"});
  group.array("object_m", raw.object_m, {frame, xyz}, {"m", "measured position, NaN: lost"});
  group.array("hand_sigma_m", raw.hand_sigma_m, {frame, xyz},
              {"m", "standard deviation of the measured position"});
  group.array("object_sigma_m", raw.object_sigma_m, {frame, xyz},
              {"m", "standard deviation of the measured position"});
}

template <class Archive, class Image>
void serialize_contact_sheet(Archive& root, Image& jpeg) {
  if constexpr (std::is_const_v<Image>) {
    if (jpeg.empty()) return;
  } else if (!root.has("contact_sheet_jpeg")) {
    return;
  }
  const h5::Axis byte = root.axis("jpeg_byte", jpeg.empty() ? h5::unknown_length : jpeg.size());
  root.array("contact_sheet_jpeg", jpeg, {byte},
             {"1", "JPEG image: camera frames with the labels drawn into them"});
}

template <class Archive, class AnyLabels>
void serialize_labels(Archive& root, AnyLabels& labels) {
  root.attribute("activity", labels.activity);
  root.attribute("summary", labels.summary);
  auto times = root.group("label"), hand = root.group("hand"), object = root.group("object"),
       raw = root.group("raw");
  const h5::Axis label =
      times.axis("time_s", labels.time_s, {"s", "when the glove measured the frame, host clock"});
  times.array("clip", labels.clip, {label}, {"1", "index of the clip"});
  times.array("glove_frame", labels.glove_frame, {label},
              {"1", "index of the glove frame in the recording, -1: lost"});
  serialize_labelled_body(hand, labels.hand, label);
  serialize_labelled_body(object, labels.object, label);
  serialize_raw(raw, labels.raw);
  serialize_contact_sheet(root, labels.contact_sheet_jpeg);
}

}  // namespace touchtrace
