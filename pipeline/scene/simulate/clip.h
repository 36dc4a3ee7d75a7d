#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// When a clip is recorded unless what it is about is dropped; `start_s` on the host's clock. Whole
/// control intervals.
struct ClipSpan {
  double start_s, length_s;

  double end_s() const { return start_s + length_s; }
};
ClipSpan clip_span(const SceneOptions& options, int clip);
/// In `options.minutes`, at least one.
int clip_count(const SceneOptions& options);

/// Physics, glove and its clock for clip number `clip`, starting at `start_s`; depends on nothing
/// but its arguments, so clips may be simulated in any order on any number of threads.
ClipMotion simulate_clip(const SceneOptions& options, int clip, double start_s);

}  // namespace touchtrace::scene
