#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/recording/check.h"
#include "pipeline/recording/clip_range.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_board_views = 3;

bool has_two_frames(const std::vector<Clip>& clips, const std::vector<double>& time_s) {
  return std::ranges::any_of(
      clips, [&](const Clip& clip) { return arrived_in(clip, time_s).size() >= 2; });
}

void check_clips(const Recording& recording, std::vector<std::string>& missing) {
  if (recording.clips.empty())
    missing.emplace_back("no clips");
  else if (std::ranges::all_of(recording.clips, &Clip::object_fell))
    missing.emplace_back("the object fell in every clip");
}

void check_glove(const Recording& recording, std::vector<std::string>& missing) {
  if (recording.gloves.empty())
    missing.emplace_back("no glove");
  else if (!has_two_frames(recording.clips, recording.gloves[0].host_time_s))
    missing.emplace_back("no clip with two glove frames");
}

void check_images(const RecordingReader& reader, std::vector<std::string>& missing) {
  const Recording& recording = reader.recording();
  if (reader.color_images() == 0)
    missing.emplace_back("no colour images");
  else if (!reader.has_depth())
    missing.emplace_back("no depth images");
  else if (recording.camera_times.frames() == 0)
    missing.emplace_back("no depth image with a colour image at its time");
  else if (!has_two_frames(recording.clips, recording.camera_times.host_time_s))
    missing.emplace_back("no clip with two camera frames");
}

/// True if the driver's values say where depth pixels lie in the colour image.
bool has_intrinsics(const CameraInfo& camera) {
  if (camera.is_registered) return camera.color_camera || camera.depth_camera;
  return camera.color_camera && camera.depth_camera && camera.depth_from_color;
}

/// Fault of a box that is drawn; empty if there is none.
std::string box_fault(const char* name, const PixelBox& box, const CameraInfo& camera) {
  const std::string found =
      fmt::format("{} ({}, {}, {}, {})", name, box.x, box.y, box.width, box.height);
  if (box.width < 0 || box.height < 0) return found + " has a negative size";
  if (box.empty() || (box.x >= 0 && box.y >= 0 && box.x <= camera.width - box.width &&
                      box.y <= camera.height - box.height))
    return {};
  const bool are_corners = box.x >= 0 && box.y >= 0 && box.width > box.x && box.height > box.y &&
                           box.width <= camera.width && box.height <= camera.height;
  return found + fmt::format(" leaves the image of {} x {}", camera.width, camera.height) +
         (are_corners ? "; did you write corners (x1, y1, x2, y2)? expected x, y, width, height"
                      : "");
}

}  // namespace

std::vector<std::string> box_faults(const Clip& clip, const Recording& recording) {
  std::vector<std::string> faults;
  for (const auto& [name, box] :
       {std::pair{"hand_box", clip.hand_box}, {"object_box", clip.object_box}})
    if (auto fault = box_fault(name, box, recording.camera); !fault.empty())
      faults.push_back(std::move(fault));
  if (!clip.hand_box.empty() && clip.hand_box == clip.object_box)
    faults.emplace_back("hand_box and object_box are the same");
  const auto frames = arrived_in(clip, recording.camera_times.host_time_s);
  if (clip.box_frame && !frames.contains(*clip.box_frame))
    faults.push_back(frames.first == frames.last
                         ? fmt::format("box_frame is {}, it has no camera frames", *clip.box_frame)
                         : fmt::format("box_frame is {}, not one of its camera frames {} to {}",
                                       *clip.box_frame, frames.first, frames.last - 1));
  return faults;
}

namespace {

bool has_mask_of_both(const Clip& clip, const RecordingReader& reader) {
  const auto frames = arrived_in(clip, reader.recording().camera_times.host_time_s);
  for (std::size_t i = frames.first; i < frames.last; ++i) {
    const auto mask = reader.read_mask(reader.color_image_of(i));
    if (std::ranges::find(mask, mask_hand) != mask.end() &&
        std::ranges::find(mask, mask_object) != mask.end())
      return true;
  }
  return false;
}

/// Lists the faults of the clips' boxes if no clip can be labelled.
void check_boxes(const RecordingReader& reader, std::vector<std::string>& missing) {
  const auto& clips = reader.recording().clips;
  std::vector<std::string> all_faults;
  std::vector<std::size_t> unmarked;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const Clip& clip = clips[i];
    if (clip.object_fell) continue;
    const auto faults = box_faults(clip, reader.recording());
    for (const auto& fault : faults) all_faults.push_back(fmt::format("clip {}: {}", i, fault));
    const bool has_boxes = clip.hand_box.width != 0 && clip.object_box.width != 0;
    if (!has_boxes && !has_mask_of_both(clip, reader))
      unmarked.push_back(i);
    else if (faults.empty())
      return;
  }
  missing.insert(missing.end(), all_faults.begin(), all_faults.end());
  if (!unmarked.empty())
    missing.push_back(
        fmt::format("neither boxes nor masks of hand and object in clip {} "
                    "(`touchtrace mark {}` draws boxes)",
                    fmt::join(unmarked, ", "), reader.path()));
}

}  // namespace

std::vector<std::string> missing_for_calibration(const RecordingReader& reader) {
  if (reader.board_views() < min_board_views)
    return {fmt::format("{} views of the chessboard, {} needed (or calibrate from --images)",
                        reader.board_views(), min_board_views)};
  const CameraInfo& camera = reader.recording().camera;
  if (camera.depth_width == 0 || reader.read_board_view(0).depth.empty()) return {};
  return {
      fmt::format("depth images of the chessboard have {} x {}, colour images {} x {}, equal "
                  "sizes needed",
                  camera.depth_width, camera.depth_height, camera.width, camera.height)};
}

std::vector<std::string> missing_for_labelling(const RecordingReader& reader,
                                               bool has_calibration) {
  std::vector<std::string> missing;
  check_clips(reader.recording(), missing);
  check_images(reader, missing);
  if (!has_calibration && !has_intrinsics(reader.recording().camera))
    missing.emplace_back("no calibration of the cameras in the file: give --calibration");
  check_boxes(reader, missing);
  return missing;
}

std::vector<std::string> missing_for_training(const Recording& recording) {
  std::vector<std::string> missing;
  check_clips(recording, missing);
  check_glove(recording, missing);
  if (!recording.gloves.empty())
    for (auto& fault : check_tactile(recording.gloves[0]).faults())
      missing.push_back(std::move(fault));
  return missing;
}

}  // namespace touchtrace
