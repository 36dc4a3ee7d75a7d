#include "pipeline/label/learn_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/interrupt.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/learn_object.h"

namespace touchtrace::label {
namespace {

constexpr float bin_m = 0.02f, farthest_m = 5.0f;
constexpr double torso_part = 0.04;  // of the image that a torso covers at least
constexpr std::size_t most_background = 15, frames_per_clip = 8;

std::vector<std::vector<std::uint16_t>> background_depths(const FrameSource& frames, int threads) {
  std::vector<std::vector<std::uint16_t>> depths(
      std::min(most_background, frames.background_frames));
  parallel_for(depths.size(), threads,
               [&](std::size_t i) { depths[i] = frames.background(i).depth; });
  return depths;
}

/// Frames spread over a clip, its first among them.
std::vector<std::size_t> sampled_frames(const ClipFrames& clip) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < std::min(frames_per_clip, clip.count); ++i)
    result.push_back(clip.first + i * clip.count / std::min(frames_per_clip, clip.count));
  return result;
}

/// Where the torso begins: from the largest peak of the depths nearer until 10 % of it. Infinite if
/// nothing as large as a torso is there.
float band_limit(const std::vector<double>& histogram, double pixels) {
  const auto peak = std::max_element(histogram.begin(), histogram.end());
  const auto low = std::max(histogram.begin(), peak - 5),
             high = std::min(histogram.end(), peak + 6);
  if (std::accumulate(low, high, 0.0) < torso_part * pixels) return farthest_m;
  auto edge = peak;
  while (edge != histogram.begin() && *edge > 0.1 * *peak) --edge;
  return bin_m * static_cast<float>(edge - histogram.begin() + 1);
}

std::vector<double> depth_counts(const Surface& surface) {
  std::vector<double> counts(static_cast<std::size_t>(farthest_m / bin_m) + 1);
  for (const auto& point : surface)
    counts[static_cast<std::size_t>(std::min(point.position_m.z(), farthest_m) / bin_m)] += 1.0;
  return counts;
}

/// Bin by bin: who walks by before the camera is not the person who stands there.
std::vector<double> median_counts(const std::vector<std::vector<double>>& frames) {
  std::vector<double> result;
  for (std::size_t bin = 0; !frames.empty() && bin < frames.front().size(); ++bin) {
    std::vector<double> counts;
    for (const auto& frame : frames) counts.push_back(frame[bin]);
    result.push_back(median(std::move(counts)));
  }
  return result;
}

/// A few frames of every clip.
std::vector<SampledFrame> sample(const SceneModel& model, const FrameSource& frames,
                                 const std::vector<ClipFrames>& clips, int threads) {
  std::vector<SampledFrame> samples;
  for (const auto& clip : clips)
    for (const auto index : sampled_frames(clip)) samples.push_back({&clip, index, {}});
  parallel_for(samples.size(), threads, [&](std::size_t i) {
    throw_if_interrupted();
    samples[i].surface = model.segmenter.moving_surface(frames.camera_frame(samples[i].index));
  });
  return samples;
}

}  // namespace

SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips,
                       int threads) {
  const auto depths_behind = background_depths(frames, threads);
  SceneModel model{Segmenter(calibration, camera, median_depth(depths_behind)),
                   depth_noise_at_1m(depths_behind, camera.depth_unit_m),
                   0.0f,
                   {},
                   {},
                   {}};
  auto samples = sample(model, frames, clips, threads);
  std::vector<std::vector<double>> depths;
  std::map<std::string, std::vector<SampledFrame>> by_object;
  for (auto& seen : samples) {
    depths.push_back(depth_counts(seen.surface));
    by_object[seen.clip->object].push_back(std::move(seen));
  }
  model.band_m = band_limit(median_counts(depths), camera.width * camera.height);
  for (auto& [object, sampled] : by_object) learn_object(model, frames, object, sampled, threads);
  return model;
}

}  // namespace touchtrace::label
