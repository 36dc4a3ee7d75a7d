#include "pipeline/label/mask_use.h"

#include <algorithm>

#include "engine/base/progress.h"
#include "pipeline/label/learn/mask_boxes.h"
#include "pipeline/label/states/lost_clips.h"

namespace touchtrace::label {
namespace {

/// Whether half of the usable clips' frames have masks.
bool are_mostly_masked(const FrameSource& frames, const std::vector<ClipFrames>& clips) {
  double masked = 0.0, all = 0.0;
  for (const auto& clip : clips) {
    if (!clip.is_usable()) continue;
    masked += static_cast<double>(masked_frames(frames, clip).size());
    all += static_cast<double>(clip.count);
  }
  return masked >= min_found_fraction * all;
}

MaskUse use_of_one_body(MaskValue body) {
  const bool is_hand = body == mask_hand;
  Progress::warn(is_hand ? "masks show the hand only: colours show the object"
                         : "masks show the object only: colours show the hand");
  return is_hand ? MaskUse::hand_only : MaskUse::object_only;
}

}  // namespace

const char* name_of(MaskUse use) {
  if (use == MaskUse::none) return "depth-color";
  return use == MaskUse::all_frames ? "masks" : "depth-color and masks";
}

MaskUse choose_masks(const FrameSource& frames, int width, const std::vector<ClipFrames>& clips,
                     const std::string& observer) {
  if (observer == "masks") return MaskUse::all_frames;
  if (observer != "auto" || frames.masked_frames.empty()) return MaskUse::none;
  if (const auto body = only_masked_body(frames)) return use_of_one_body(*body);
  const bool show_both = std::ranges::any_of(clips, [&](const ClipFrames& clip) {
    return clip.is_usable() && has_mask_of_both(frames, width, clip);
  });
  if (!show_both) {
    Progress::warn("no mask shows both hand and object: colours are used instead of masks");
    return MaskUse::none;
  }
  return are_mostly_masked(frames, clips) ? MaskUse::all_frames : MaskUse::some_frames;
}

}  // namespace touchtrace::label
