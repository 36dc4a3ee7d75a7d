#include "pipeline/label/track/track_clips.h"

#include "calib/board/opencv_threads.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"

namespace touchtrace::label {
namespace {

SegmentedFrame segment(const SceneModel& scene, const FrameSource& frames, const TrackerKind& kind,
                       const ClipFrames& clip, std::size_t index) {
  SegmentedFrame result{frames.camera_frame(index), {}, {}};
  result.surface = scene.observer->observe(result.frame, clip.object);
  const auto& camera = scene.segmenter->color_camera();
  if (kind.create)
    result.image = masked_image(result.frame, result.surface, camera.width, camera.height);
  return result;
}

std::vector<TrackingPass> passes_of(const std::vector<ClipFrames>& clips) {
  std::vector<TrackingPass> passes;
  for (const auto& clip : clips) {
    if (!clip.is_usable()) continue;
    passes.push_back({&clip, false});
    if (clip.box_frame > clip.first) passes.push_back({&clip, true});
  }
  return passes;
}

}  // namespace

std::vector<ClipTrack> track_clips(const SceneModel& scene, const FrameSource& frames,
                                   const std::vector<ClipFrames>& clips,
                                   const std::vector<double>& camera_time_s,
                                   const Eigen::Vector3d& gravity_m_per_s2, const TrackerKind& kind,
                                   int num_threads) {
  const auto passes = passes_of(clips);
  std::size_t total = 0;
  for (const auto& pass : passes) total += pass.count();
  Progress progress("tracking hand and object", total);
  FramePrefetcher prefetcher(passes, [&](const ClipFrames& clip, std::size_t index) {
    progress.advance();
    return segment(scene, frames, kind, clip, index);
  });
  std::vector<ClipTrack> tracked(passes.size()), tracks(clips.size());
  const OpenCvThreads single_threaded(1);  // passes are the parallel work
  const std::size_t workers = thread_count(num_threads);
  parallel_for(passes.size() + workers, num_threads, [&](std::size_t i) {
    if (i >= passes.size()) return prefetcher.run_worker();
    FramePrefetcher::Reader reader(prefetcher, i);
    tracked[i] = track_pass(scene, reader, passes[i], camera_time_s, gravity_m_per_s2, kind);
  });
  for (std::size_t i = 0; i < passes.size(); ++i) {
    auto& track = tracks[static_cast<std::size_t>(passes[i].clip - clips.data())];
    track = passes[i].is_backward ? join(std::move(tracked[i]), track) : std::move(tracked[i]);
  }
  return tracks;
}

}  // namespace touchtrace::label
