#include "pipeline/study/tracker_choice.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "pipeline/label/observe/color_classes.h"
#include "pipeline/label/states/timeline.h"

namespace touchtrace::study {
namespace {

constexpr std::size_t max_clips = 8;  // per object
// Fraction of an object's boxes, which also contain fingers and background. Simulated objects that
// are visible in them: 5 to 74 %; one of the glove's colour: 0 %.
constexpr double min_own_colors = 0.03;

struct Boxed {
  label::Surface image;  ///< all pixels, without 3-D points
  label::ClipFrames clip;
};

label::Surface pixels_of(const RgbdFrame& frame, const CameraInfo& camera) {
  label::Surface pixels;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const auto at = 3 * static_cast<std::size_t>(v * camera.width + u);
      pixels.push_back({Eigen::Vector3f::Zero(),
                        static_cast<std::int16_t>(u),
                        static_cast<std::int16_t>(v),
                        {frame.color[at], frame.color[at + 1], frame.color[at + 2]}});
    }
  return pixels;
}

/// Box frames of clips that have boxes, by object.
std::map<std::string, std::vector<Boxed>> boxed_frames(const Recording& recording,
                                                       const label::FrameSource& frames) {
  std::map<std::string, std::vector<Boxed>> result;
  for (const auto& clip : label::clip_frames(recording)) {
    auto& of_object = result[clip.object];
    if (clip.is_usable() && clip.has_boxes() && of_object.size() < max_clips)
      of_object.push_back({pixels_of(frames.camera_frame(clip.box_frame), recording.camera), clip});
  }
  return result;
}

/// Fraction of an object's boxes whose colours belong to the object alone.
double own_colors(const std::vector<Boxed>& frames) {
  label::ColorClasses colors;
  for (const auto& [image, clip] : frames) colors.learn(image, clip.hand_box, clip.object_box);
  colors.build_table();
  double all = 0.0, own = 0.0;
  for (const auto& [image, clip] : frames)
    for (const auto& pixel : image)
      if (contains(clip.object_box, pixel))
        all += 1.0, own += colors.classify(pixel.rgb) == label::Body::object;
  return all > 0.0 ? own / all : 0.0;
}

}  // namespace

TrackerChoice default_tracker() {
  return {"csrt-fast", "default; a recording shows whether colour alone suffices"};
}

TrackerChoice choose_tracker(const Recording& recording, const label::FrameSource& frames) {
  std::string least;
  double share = 1.0;
  for (const auto& [object, boxed] : boxed_frames(recording, frames)) {
    if (boxed.empty()) return {"csrt-fast", fmt::format("no clip of '{}' has both boxes", object)};
    if (const double own = own_colors(boxed); own <= share) share = own, least = object;
  }
  const auto seen = fmt::format("{:.0f} % of the box of '{}' differs in colour from the hand",
                                100.0 * share, least);
  if (share >= min_own_colors)
    return {"component", seen + ": colour and depth suffice and are several times faster"};
  return {"csrt-fast", seen + ": shape is needed to separate it from the hand"};
}

}  // namespace touchtrace::study
