#include "pipeline/export/message_streams.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/base/error.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/export/predictions.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

// Names of ROS drivers for a frame with x right, y down, z forward.
constexpr const char *color_frame = "camera_color_optical_frame",
                     *depth_frame = "camera_depth_optical_frame";

using Streams = std::vector<MessageStream>;
using Bytes = std::span<const std::uint8_t>;

template <class Value>
Bytes bytes_of_values(const std::vector<Value>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(Value)};
}

std::array<double, 3> vector_at(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

RosBodyState state_at(const LabelledBody& body, std::size_t i) {
  return {vector_at(body.position_m, i), vector_at(body.velocity_m_per_s, i),
          std::span<const double, 36>(&body.covariance[36 * i], 36)};
}

/// Streams of the positions and states of a body. `state`: that of a message, by its index.
void append_states(Streams& streams, const std::string& topic, const std::string& body,
                   const std::vector<double>& time_s,
                   const std::function<RosBodyState(std::size_t)>& state) {
  streams.push_back({topic + "/position", &point_stamped_type(), color_frame, time_s,
                     [state](const RosHeader& header, std::size_t i) {
                       return point_stamped(header, state(i).position_m);
                     }});
  streams.push_back({topic + "/odometry", &odometry_type(), color_frame, time_s,
                     [state, body](const RosHeader& header, std::size_t i) {
                       return odometry(header, body, state(i));
                     }});
}

void append_body(Streams& streams, const std::string& name,
                 const std::shared_ptr<const Labels>& labels, const LabelledBody Labels::*body) {
  const auto indices = measured_labels((*labels).*body);
  std::vector<double> time_s;
  for (const std::size_t i : indices) time_s.push_back(labels->time_s[i]);
  append_states(streams, "/" + name, name, time_s,
                [=](std::size_t i) { return state_at((*labels).*body, indices[i]); });
}

void append_predictions(Streams& streams, const std::string& name, const Predictions& predictions) {
  const auto& position_m = predictions.bodies.at(name + "_position_m");
  const auto& velocity_m_per_s = predictions.bodies.at(name + "_velocity_m_per_s");
  append_states(streams, "/" + name + "/predicted", name, predictions.time_s, [=](std::size_t i) {
    return RosBodyState{vector_at(position_m, i), vector_at(velocity_m_per_s, i), std::nullopt};
  });
}

using SharedReader = std::shared_ptr<const RecordingReader>;

std::string tactile_image(const RosHeader& header, const GloveStream& glove, std::size_t i) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::vector<float> pressure(taxels);
  counts_to_pressure(glove.info, std::span(glove.counts).subspan(i * taxels, taxels), pressure);
  return image(header, static_cast<std::uint32_t>(glove.info.cols),
               static_cast<std::uint32_t>(glove.info.rows), "32FC1", bytes_of_values(pressure));
}

void append_gloves(Streams& streams, const SharedReader& reader) {
  const auto& gloves = reader->recording().gloves;
  for (std::size_t g = 0; g < gloves.size(); ++g) {
    const std::string name = fmt::format("glove{}", g);
    streams.push_back({"/" + name + "/tactile", &image_type(), name, gloves[g].host_time_s,
                       [reader, g](const RosHeader& header, std::size_t i) {
                         return tactile_image(header, reader->recording().gloves[g], i);
                       }});
  }
}

/// Frames of a camera. Keeps the last one, as its colour and depth are used one after the other.
class CameraFrames {
 public:
  explicit CameraFrames(SharedReader reader) : reader_(std::move(reader)) {}

  const CameraInfo& camera() const { return reader_->recording().camera; }
  const RgbdFrame& at(std::size_t index) {
    if (index_ != index) frame_ = reader_->read_camera_frame(index);
    index_ = index;
    return frame_;
  }

 private:
  SharedReader reader_;
  std::optional<std::size_t> index_;
  RgbdFrame frame_;
};

std::string color_image(const RosHeader& header, CameraFrames& frames, std::size_t i) {
  const CameraInfo& camera = frames.camera();
  return image(header, static_cast<std::uint32_t>(camera.width),
               static_cast<std::uint32_t>(camera.height), "rgb8", frames.at(i).color);
}

/// Millimetres in 16 bits, or metres in floating point, as ROS REP 118 demands.
std::string depth_image(const RosHeader& header, CameraFrames& frames, std::size_t i) {
  constexpr double millimetre_m = 0.001, tolerance_m = 1e-9;
  const CameraInfo& camera = frames.camera();
  const auto& counts = frames.at(i).depth;
  const auto width = static_cast<std::uint32_t>(camera.depth_image_width()),
             height = static_cast<std::uint32_t>(camera.depth_image_height());
  if (std::abs(camera.depth_unit_m - millimetre_m) < tolerance_m)
    return image(header, width, height, "16UC1", bytes_of_values(counts));
  std::vector<float> depth_m;
  for (const auto count : counts)
    depth_m.push_back(static_cast<float>(count * camera.depth_unit_m));
  return image(header, width, height, "32FC1", bytes_of_values(depth_m));
}

/// Images and, if the intrinsics are known, camera_info of one camera.
struct CameraTopics {
  const char *name, *frame_id;
  std::optional<Camera> intrinsics;
  std::string (*message)(const RosHeader&, CameraFrames&, std::size_t);
};

void append_camera(Streams& streams, const std::shared_ptr<CameraFrames>& frames,
                   const std::vector<double>& time_s, const CameraTopics& topics) {
  const std::string prefix = std::string("/camera/") + topics.name;
  streams.push_back({prefix + "/image_raw", &image_type(), topics.frame_id, time_s,
                     [frames, message = topics.message](const RosHeader& header, std::size_t i) {
                       return message(header, *frames, i);
                     }});
  if (topics.intrinsics)
    streams.push_back({prefix + "/camera_info", &camera_info_type(), topics.frame_id, time_s,
                       [camera = *topics.intrinsics](const RosHeader& header, std::size_t) {
                         return camera_info(header, camera);
                       }});
}

void append_cameras(Streams& streams, const SharedReader& reader) {
  const CameraInfo& camera = reader->recording().camera;
  const auto& time_s = reader->recording().camera_times.host_time_s;
  const auto frames = std::make_shared<CameraFrames>(reader);
  append_camera(streams, frames, time_s, {"color", color_frame, camera.color_camera, color_image});
  if (!reader->has_depth()) return;
  append_camera(streams, frames, time_s,
                {"depth", camera.is_registered ? color_frame : depth_frame,
                 camera.is_registered ? camera.color_camera : camera.depth_camera, depth_image});
}

void append_recording(MessageStreams& all, const std::filesystem::path& file, bool images) {
  const auto reader = std::make_shared<const RecordingReader>(file);
  all.epoch_unix_s = reader->recording().epoch_unix_s;
  append_gloves(all.streams, reader);
  if (images && reader->recording().camera_times.frames() > 0) append_cameras(all.streams, reader);
}

}  // namespace

std::vector<std::size_t> measured_labels(const LabelledBody& body) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < body.quality.size(); ++i) {
    const double* p = &body.position_m[3 * i];
    if ((body.quality[i] & (quality_lost | quality_gap)) == 0 && std::isfinite(p[0] + p[1] + p[2]))
      indices.push_back(i);
  }
  return indices;
}

MessageStreams open_streams(const ExportRequest& request) {
  MessageStreams all;
  if (request.kind == FileKind::labels) {
    const auto labels = std::make_shared<const Labels>(read_labels(request.input));
    append_body(all.streams, "hand", labels, &Labels::hand);
    append_body(all.streams, "object", labels, &Labels::object);
  }
  if (request.kind == FileKind::predictions) {
    const Predictions predictions = read_predictions(request.input);
    append_predictions(all.streams, "hand", predictions);
    append_predictions(all.streams, "object", predictions);
  }
  const auto& recording = request.kind == FileKind::recording ? request.input : request.recording;
  if (!recording.empty()) append_recording(all, recording, request.images);
  std::erase_if(all.streams, [](const MessageStream& s) { return s.time_s.empty(); });
  if (all.streams.empty())
    throw data_error(fmt::format("{} has nothing to write", request.input.string()),
                     "a recording without a glove needs --images");
  return all;
}

}  // namespace touchtrace
