#include "pipeline/mark/mark_session.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr int jpeg_quality = 92;

nlohmann::json box_json(const PixelBox& box) {
  if (box.empty()) return nullptr;
  return {box.x, box.y, box.width, box.height};
}

}  // namespace

MarkSession::MarkSession(fs::path recording, fs::path output, bool overwrite)
    : path_(std::move(recording)),
      output_(std::move(output)),
      overwrite_(overwrite || fs::absolute(path_) == fs::absolute(output_)),
      reader_(path_) {
  { const OutputFile writable(output_, overwrite_); }
  if (reader_.recording().clips.empty() || reader_.recording().camera_times.frames() == 0)
    throw data_error(fmt::format("{} has no clips or no colour images", path_.string()),
                     "`touchtrace check` describes it");
  for (std::size_t i = 0; i < reader_.recording().clips.size(); ++i) {
    const Clip& clip = reader_.recording().clips[i];
    const auto frames = frames_of(clip);
    if (frames.size() > 0 && (!clip.hand_box.empty() || !clip.object_box.empty()))
      boxes_[i] = {i, clip.box_frame.value_or(frames.first), clip.hand_box, clip.object_box};
  }
}

IndexRange MarkSession::frames_of(const Clip& clip) const {
  return arrived_in(clip, recording().camera_times.host_time_s);
}

nlohmann::json MarkSession::state() const {
  const Recording& r = recording();
  nlohmann::json clips = nlohmann::json::array();
  for (std::size_t i = 0; i < r.clips.size(); ++i) {
    const Clip& clip = r.clips[i];
    const auto frames = frames_of(clip);
    if (frames.size() == 0) continue;
    const auto found = boxes_.find(i);
    const ClipBoxes boxes =
        found != boxes_.end() ? found->second : ClipBoxes{i, frames.first, {}, {}};
    clips.push_back({{"clip", i},
                     {"object_name", clip.object},
                     {"first", frames.first},
                     {"last", frames.last - 1},
                     {"frame", boxes.frame},
                     {"hand", box_json(boxes.hand)},
                     {"object", box_json(boxes.object)}});
  }
  return {{"width", r.camera.width}, {"height", r.camera.height}, {"clips", clips}};
}

std::string MarkSession::jpeg(std::size_t frame) const {
  const CameraInfo& camera = recording().camera;
  if (frame >= recording().camera_times.frames())
    throw data_error(fmt::format("frame {} does not exist", frame), "frames are counted from 0");
  auto color = reader_.read_camera_frame(frame).color;
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(camera.height, camera.width, CV_8UC3, color.data()), bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  return {bytes.begin(), bytes.end()};
}

void MarkSession::save(const std::vector<ClipBoxes>& boxes) {
  for (const ClipBoxes& each : boxes) require_plausible(each, recording());
  auto merged = boxes_;
  for (const ClipBoxes& each : boxes) merged[each.clip] = each;
  auto clips = recording().clips;
  for (const auto& [clip, drawn] : merged) {
    clips[clip].hand_box = drawn.hand, clips[clip].object_box = drawn.object;
    clips[clip].box_frame = reader_.color_image_of(drawn.frame);
  }
  rewrite_clips(path_, output_, clips, {}, overwrite_);
  boxes_ = std::move(merged);
  overwrite_ = true;  // its own file
}

}  // namespace touchtrace
