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

constexpr float bin_m = 0.02f, max_depth_m = 5.0f;
constexpr double min_torso_fraction = 0.04;  // of the image
constexpr std::size_t max_background_frames = 15, frames_per_clip = 8;

std::vector<std::vector<std::uint16_t>> background_depths(const FrameSource& frames,
                                                          int num_threads) {
  std::vector<std::vector<std::uint16_t>> depths(
      std::min(max_background_frames, frames.background_frames));
  parallel_for(depths.size(), num_threads,
               [&](std::size_t i) { depths[i] = frames.background(i).depth; });
  return depths;
}

/// Frames spread evenly over a clip, starting with its first.
std::vector<std::size_t> sampled_frames(const ClipFrames& clip) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < std::min(frames_per_clip, clip.count); ++i)
    result.push_back(clip.first + i * clip.count / std::min(frames_per_clip, clip.count));
  return result;
}

/// Front of the torso [m]: from the largest peak of the depth histogram towards the camera down to
/// 10 % of it. max_depth_m if the peak is smaller than a torso.
float band_limit(const std::vector<double>& histogram, double pixels) {
  const auto peak = std::max_element(histogram.begin(), histogram.end());
  const auto low = std::max(histogram.begin(), peak - 5),
             high = std::min(histogram.end(), peak + 6);
  if (std::accumulate(low, high, 0.0) < min_torso_fraction * pixels) return max_depth_m;
  auto edge = peak;
  while (edge != histogram.begin() && *edge > 0.1 * *peak) --edge;
  return bin_m * static_cast<float>(edge - histogram.begin() + 1);
}

std::vector<double> depth_counts(const Surface& surface) {
  std::vector<double> counts(static_cast<std::size_t>(max_depth_m / bin_m) + 1);
  for (const auto& point : surface)
    counts[static_cast<std::size_t>(std::min(point.position_m.z(), max_depth_m) / bin_m)] += 1.0;
  return counts;
}

/// Per-bin median over frames, robust against people who walk through the image.
std::vector<double> median_counts(const std::vector<std::vector<double>>& frames) {
  std::vector<double> result;
  for (std::size_t bin = 0; !frames.empty() && bin < frames.front().size(); ++bin) {
    std::vector<double> counts;
    for (const auto& frame : frames) counts.push_back(frame[bin]);
    result.push_back(median(std::move(counts)));
  }
  return result;
}

std::vector<SampledFrame> sample(const SceneModel& model, const FrameSource& frames,
                                 const std::vector<ClipFrames>& clips, int num_threads) {
  std::vector<SampledFrame> samples;
  for (const auto& clip : clips)
    for (const auto index : sampled_frames(clip)) samples.push_back({&clip, index, {}});
  parallel_for(samples.size(), num_threads, [&](std::size_t i) {
    throw_if_interrupted();
    samples[i].surface = model.segmenter.foreground_surface(frames.camera_frame(samples[i].index));
  });
  return samples;
}

}  // namespace

SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips,
                       int num_threads) {
  const auto background = background_depths(frames, num_threads);
  SceneModel model{Segmenter(calibration, camera, median_depth(background)),
                   depth_noise_at_1m(background, camera.depth_unit_m),
                   0.0f,
                   {},
                   {},
                   {}};
  auto samples = sample(model, frames, clips, num_threads);
  std::vector<std::vector<double>> depths;
  std::map<std::string, std::vector<SampledFrame>> by_object;
  for (auto& frame : samples) {
    depths.push_back(depth_counts(frame.surface));
    by_object[frame.clip->object].push_back(std::move(frame));
  }
  model.band_m = band_limit(median_counts(depths), camera.width * camera.height);
  for (auto& [object, sampled] : by_object)
    learn_object(model, frames, object, sampled, num_threads);
  return model;
}

}  // namespace touchtrace::label
