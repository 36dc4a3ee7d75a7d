#include "pipeline/label/learn/learn_scene.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "pipeline/label/learn/box_warnings.h"
#include "pipeline/label/learn/learn_colors.h"
#include "pipeline/label/learn/learn_object.h"
#include "pipeline/label/observe/background.h"
#include "pipeline/label/observe/depth_color_observer.h"
#include "pipeline/label/observe/mask_observer.h"
#include "pipeline/label/observe/masked_color_observer.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_background_frames = 15, min_frames_per_clip = 8, min_frames = 32,
                      min_box_points = 12;

using ObjectSamples = std::map<std::string, SampledFrames>;  ///< of usable clips, by object

DepthImages read_depths(std::size_t count, int num_threads,
                        const std::function<RgbdFrame(std::size_t)>& read) {
  DepthImages depths(count);
  parallel_for(count, num_threads, [&](std::size_t i) { depths[i] = read(i).depth; });
  return depths;
}

/// At most `max_count` frames of a clip, evenly spread, and its box frame.
std::vector<std::size_t> sampled_frames(const ClipFrames& clip, std::size_t max_count) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < std::min(max_count, clip.count); ++i)
    result.push_back(clip.first + i * clip.count / std::min(max_count, clip.count));
  if (clip.count > 0 && std::ranges::find(result, clip.box_frame) == result.end())
    result.push_back(clip.box_frame);
  return result;
}

/// Unsets the background of pixels on which the boxes show a body that hardly moves: no image shows
/// more distant points.
void unset_occupied(const Segmenter& segmenter, const RgbdFrame& frame, const ClipFrames& clip,
                    std::vector<std::uint16_t>& background) {
  constexpr std::size_t near_part = 5;  // a fifth of a box at least shows the body
  for (const PixelBox& box : {clip.hand_box, clip.object_box}) {
    auto pixels = segmenter.depth_pixels_in(frame, box);
    if (pixels.empty()) continue;
    std::ranges::sort(pixels, {}, [&](std::size_t i) { return frame.depth[i]; });
    const double near = frame.depth[pixels[pixels.size() / near_part]],
                 gap = segmenter.background_gap(near);
    std::erase_if(pixels, [&](std::size_t i) { return frame.depth[i] > near + 2.0 * gap; });
    const auto is_static = [&](std::size_t i) {
      return background[i] > 0 && background[i] < frame.depth[i] + gap;
    };
    // where most of the body moves away, what stays is not the body
    if (2 * static_cast<std::size_t>(std::ranges::count_if(pixels, is_static)) < pixels.size())
      continue;
    for (const auto i : pixels)
      if (is_static(i)) background[i] = 0;
  }
}

/// Background behind the moving bodies, for a recording without images of the empty scene.
std::vector<std::uint16_t> background_behind(const Segmenter& segmenter, const FrameSource& frames,
                                             const std::vector<ClipFrames>& clips,
                                             const DepthImages& depths) {
  auto background = farthest_depth(depths, 0.5 * segmenter.background_gap(0.0));
  for (const auto& clip : clips)
    if (clip.is_usable())
      unset_occupied(segmenter, frames.camera_frame(clip.box_frame), clip, background);
  return background;
}

/// Depth images of the empty scene or, if there are none, of frames spread over the clips.
DepthImages scene_depths(const FrameSource& frames, const std::vector<ClipFrames>& clips,
                         int num_threads) {
  if (frames.background_frames > 0)
    return read_depths(std::min(max_background_frames, frames.background_frames), num_threads,
                       frames.background);
  std::vector<std::size_t> all;
  for (const auto& clip : clips)
    for (std::size_t i = 0; clip.is_usable() && i < clip.count; ++i) all.push_back(clip.first + i);
  const std::size_t count = std::min(min_frames, all.size());
  return read_depths(count, num_threads, [&](std::size_t i) {
    return frames.camera_frame(all[i * all.size() / count]);
  });
}

/// Why a clip's boxes cannot be used, given the points of its box frame; empty: they can.
std::string box_problem(const ClipFrames& clip, const Surface& surface) {
  for (const auto& [box, body] : {std::pair{clip.hand_box, "hand"}, {clip.object_box, "object"}})
    if (points_in(surface, box).size() < min_box_points)
      return fmt::format(
          "the {}'s {} (x {}, y {}, width {}, height {}) in camera frame {} contains "
          "only background or no depth",
          body, clip.has_mask_boxes ? "mask" : "box", box.x, box.y, box.width, box.height,
          clip.box_frame);
  return {};
}

/// `masks`: classifies the points; null: without classes.
SampledFrames sample(const Segmenter& segmenter, const Observer* masks, const FrameSource& frames,
                     const std::vector<ClipFrames>& clips, int num_threads) {
  const std::size_t frames_per_clip =
      std::max(min_frames_per_clip, min_frames / std::max<std::size_t>(1, clips.size()));
  SampledFrames samples;
  for (const auto& clip : clips)
    if (clip.is_usable())
      for (const auto index : sampled_frames(clip, frames_per_clip))
        samples.push_back({&clip, index, {}});
  parallel_for(samples.size(), num_threads, [&](std::size_t i) {
    throw_if_interrupted();
    const auto frame = frames.camera_frame(samples[i].index);
    samples[i].surface = segmenter.foreground_surface(frame);
    if (masks) masks->classify(frame, samples[i].clip->object, samples[i].surface);
  });
  return samples;
}

/// Samples of the clips whose boxes can be used; sets the problem of the others.
ObjectSamples usable_samples(std::vector<ClipFrames>& clips, SampledFrames samples) {
  for (const auto& sample : samples)
    if (sample.has_boxes())
      clips[static_cast<std::size_t>(sample.clip - clips.data())].problem =
          box_problem(*sample.clip, sample.surface);
  ObjectSamples by_object;
  for (auto& sample : samples)
    if (sample.clip->is_usable()) by_object[sample.clip->object].push_back(std::move(sample));
  return by_object;
}

/// Replaces the points of frames with a mask by those that masks and colours show.
void observe_again(const Observer& observer, const FrameSource& frames, SampledFrames& samples) {
  for (auto& sample : samples)
    if (auto frame = frames.camera_frame(sample.index); !frame.mask.empty())
      sample.surface = observer.observe(frame, sample.clip->object);
}

/// Calls `learn` for every object. Where it throws, all clips of the object have a problem.
template <class Learn>
void learn_objects(std::vector<ClipFrames>& clips, ObjectSamples& samples, Learn&& learn) {
  for (auto& [object, of_object] : samples) try {
      learn(object, of_object);
    } catch (const Error& error) {
      if (error.code() != ExitCode::data) throw;
      for (auto& clip : clips)
        if (clip.object == object && clip.is_usable()) clip.problem = error.what();
    }
}

}  // namespace

SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, std::vector<ClipFrames>& clips, bool use_masks,
                       int num_threads) {
  const auto segmenter = std::make_shared<Segmenter>(calibration, camera);
  const auto without_background = std::make_shared<Segmenter>(*segmenter);
  const auto depths = scene_depths(frames, clips, num_threads);
  const auto noise_at_1m = depth_noise_at_1m(depths, camera.depth_unit_m);
  if (!use_masks && depths.size() >= min_frames && !noise_at_1m)
    Progress::warn(
        "nothing in the images is at rest: if the camera moves, positions are relative to it, and "
        "other things may be taken for hand and object; look at the labels with --preview");
  if (!use_masks)
    segmenter->set_background(frames.background_frames > 0
                                  ? median_depth(depths)
                                  : background_behind(*segmenter, frames, clips, depths),
                              noise_at_1m);
  SceneModel model{.segmenter = segmenter,
                   .observer = nullptr,
                   .depth_noise_at_1m = noise_at_1m,
                   .has_all_masks = use_masks,
                   .has_some_masks = !use_masks && !frames.masked_frames.empty(),
                   .only_masked_body = frames.only_masked_body};
  const auto colors = std::make_shared<DepthColorObserver>(segmenter);
  if (use_masks)
    model.observer = std::make_shared<MaskObserver>(segmenter);
  else if (model.has_some_masks)
    model.observer =
        std::make_shared<MaskedColorObserver>(colors, without_background, frames.only_masked_body);
  else
    model.observer = colors;
  auto samples = usable_samples(
      clips,
      sample(*segmenter, use_masks ? model.observer.get() : nullptr, frames, clips, num_threads));
  learn_objects(clips, samples, [&](const std::string& object, SampledFrames& of_object) {
    if (use_masks) {
      find_hands(of_object, num_threads);
    } else {
      auto learnt = learn_colors(*segmenter, object, of_object, num_threads);
      if (!learnt.separates_object) model.objects_with_hand_color.insert(object);
      if (learnt.shared_radius_m) model.objects_with_rest_color.insert(object);
      colors->set_colors(object, std::move(learnt.classes), learnt.shared_radius_m);
      if (frames.only_masked_body) observe_again(*model.observer, frames, of_object);
    }
    warn_of_boxes(segmenter->color_camera(), of_object);
    learn_object(model, frames, object, of_object, num_threads);
  });
  return model;
}

}  // namespace touchtrace::label
