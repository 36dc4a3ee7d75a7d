#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Planned time of a clip on the host clock, in whole control intervals. The clip ends earlier if
/// the object falls.
struct ClipSpan {
  double start_s, length_s;

  double end_s() const { return start_s + length_s; }
};
ClipSpan clip_span(const SceneOptions& options, int clip);
/// Number of clips in `options.minutes`, at least 1.
int clip_count(const SceneOptions& options);

/// Simulates physics and glove of clip number `clip`, starting at `start_s`. Depends only on its
/// arguments, so clips may be simulated in any order on any threads.
ClipMotion simulate_clip(const SceneOptions& options, int clip, double start_s);

}  // namespace touchtrace::scene
