#include "pipeline/recording/recording_schema.h"

namespace touchtrace {
namespace {

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

std::array<double, 3> gravity_values(const CameraInfo& camera) {
  const Eigen::Vector3d g = camera.gravity_m_per_s2.value_or(Eigen::Vector3d::Zero());
  return {g.x(), g.y(), g.z()};
}

std::array<double, 4> depth_intrinsics(const CameraInfo& camera) {
  if (!camera.depth_camera) return {};
  return {camera.depth_camera->fx, camera.depth_camera->fy, camera.depth_camera->cx,
          camera.depth_camera->cy};
}

void set_driver_values(CameraInfo& camera, const std::array<double, 3>& gravity,
                       const std::array<double, 4>& intrinsics) {
  const Eigen::Vector3d g(gravity.data());
  if (!g.isZero()) camera.gravity_m_per_s2 = g;
  const auto& [fx, fy, cx, cy] = intrinsics;
  if (fx > 0.0) camera.depth_camera = Camera{camera.width, camera.height, fx, fy, cx, cy};
}

std::vector<Clip> read_clips(const h5::Loader& root) {
  ClipColumns columns;
  const h5::Loader group = root.group("clips");
  serialize_clips(group, columns);
  if (root.faults().contains(group.path())) return {};
  std::vector<Clip> clips(columns.start_s.size());
  for (std::size_t i = 0; i < clips.size(); ++i)
    clips[i] = {columns.start_s[i],          columns.end_s[i],
                columns.object[i],           columns.object_fell[i] != 0,
                box_at(columns.hand_box, i), box_at(columns.object_box, i)};
  return clips;
}

Provenance read_provenance(const h5::Loader& root) {
  nlohmann::json json;
  root.attribute("provenance", json);
  try {
    return json.get<Provenance>();
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
