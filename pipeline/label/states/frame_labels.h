#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/states/timeline.h"
#include "pipeline/recording/labels.h"

namespace touchtrace::label {

/// What the labels say about one camera frame.
struct FrameLabel {
  std::optional<std::size_t> clip;   ///< nullopt: between clips
  std::optional<std::size_t> label;  ///< index of the label nearest in time; nullopt: none is near
  std::optional<std::size_t> raw;    ///< index of the frame's measurement in RawTrack
  bool has_boxes = false;            ///< the clip's boxes were drawn in this frame
};

/// Finds clip, label and measurement of every camera frame. `timeline`: that of the labels.
std::vector<FrameLabel> frame_labels(const Recording& recording, const Timeline& timeline,
                                     const Labels& labels);

}  // namespace touchtrace::label
