#include "pipeline/label/learn_object.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "engine/base/error.h"
#include "engine/base/integer_math.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/box_planes.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t min_patch_points = 12, max_patch_starts = 16;
constexpr std::size_t max_boxed_views = 16, max_other_views = 48;
constexpr double toss_m = 0.5;  // points farther from the hand are not the object
// Visible fractions of the object's disc. Below the first, colours learnt near the hand are not
// trusted; below the second the shape is taken from the boxes; below the third a learnt sphere is.
constexpr double min_learnt_color_fraction = 0.4, min_shape_fraction = 0.25,
                 min_sphere_fraction = 0.5;
constexpr double high_quantile = 0.8, view_reach_silhouettes = 2.5;
constexpr double min_visible_frames = 0.1;  // an object is rarely hidden in more of the frames
/// Error of a sphere's centre along an image axis over half the RMS difference of half width and
/// half height, for a randomly rotated ellipsoid of which the part within 60 degrees of the line of
/// sight is visible.
constexpr double box_centre_per_unevenness = 1.44;

using SampledFrames = std::vector<SampledFrame>;

double quantile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// The object's patch in one of the sampled frames.
struct Sighting {
  std::size_t frame;
  Patch patch;
  std::optional<PixelBox> box;  ///< in a clip's first frame: around the whole object
};

/// Largest patch of a class over starts spread over its points.
std::optional<Patch> largest_patch(const Surface& surface, Body body, double radius_m) {
  const Surface own = points_of(surface, body);
  std::optional<Patch> largest;
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / max_patch_starts) {
    auto patch =
        find_patch(own, body, own[i].position_m.cast<double>(), radius_m, min_patch_points);
    if (patch && (!largest || patch->points_m.size() > largest->points_m.size()))
      largest = std::move(patch);
  }
  return largest;
}

std::optional<Eigen::Vector3d> find_hand(const Surface& surface) {
  const auto patch = largest_patch(surface, Body::hand, hand_patch_radius_m);
  return patch ? std::optional(patch->centroid_m) : std::nullopt;
}

/// Size and place of an object according to the clips' boxes.
struct BoxedObject {
  double radius_m;
  double unevenness_m;  ///< RMS of half the difference of half width and half height
  double from_hand_m;

  ObjectShape sphere() const {
    return {radius_m, std::nullopt, unevenness_m, box_centre_per_unevenness * unevenness_m};
  }
};

/// Points within reach of a toss from where the hand holds the object; empty without a hand.
Surface near_hand(const SampledFrame& sample, const BoxedObject& boxed) {
  Surface near;
  if (sample.hand_m)
    std::ranges::copy_if(sample.surface, std::back_inserter(near), [&](const SurfacePoint& point) {
      return (point.position_m.cast<double>() - *sample.hand_m).norm() < boxed.from_hand_m + toss_m;
    });
  return near;
}

std::optional<PixelBox> box_of(const SampledFrame& sample) {
  return sample.index == sample.clip->first ? std::optional(sample.clip->object_box) : std::nullopt;
}

std::vector<Sighting> sightings_of(const SampledFrames& samples, const BoxedObject& boxed) {
  std::vector<Sighting> result;
  for (const auto& sample : samples)
    if (auto patch = largest_patch(near_hand(sample, boxed), Body::object,
                                   object_patch_radius_factor * boxed.radius_m))
      result.push_back({sample.index, std::move(*patch), box_of(sample)});
  return result;
}

void learn_colors(const SampledFrame& first, const std::string& object, ColorClasses& colors) {
  const auto& [hand_box, object_box] = std::tie(first.clip->hand_box, first.clip->object_box);
  if (std::ranges::none_of(first.surface, [&](const auto& p) { return contains(object_box, p); }))
    throw data_error(fmt::format("object box of '{}' in camera frame {} contains only background",
                                 object, first.index),
                     "draw the box on the object, in each clip's first frame");
  colors.learn(first.surface, hand_box, object_box);
}

void classify(ColorClasses& colors, SampledFrames& samples) {
  colors.build_table();
  for (auto& sample : samples) {
    colors.assign(sample.surface);
    sample.hand_m = find_hand(sample.surface);
  }
}

Surface all_near_hand(const SampledFrames& samples, const BoxedObject& boxed) {
  Surface all;
  for (const auto& sample : samples)
    std::ranges::copy(near_hand(sample, boxed), std::back_inserter(all));
  return all;
}

/// Medians over the clips whose first frame shows the hand, with boxes as discs at the hand's
/// distance.
BoxedObject boxed_object(const SceneModel& model, const std::string& object,
                         const SampledFrames& samples) {
  const auto& camera = model.segmenter.color_camera();
  std::vector<double> radii, distances;
  double uneven_m2 = 0.0;
  for (const auto& sample : samples) {
    const auto& box = sample.clip->object_box;
    if (sample.index != sample.clip->first || !sample.hand_m) continue;
    const double z = sample.hand_m->z(), half_pixel_m = 0.5 * z / camera.fx;
    radii.push_back(half_pixel_m * std::sqrt(static_cast<double>(box.width * box.height)));
    uneven_m2 += std::pow(half_pixel_m * 0.5 * (box.width - box.height), 2);
    const Eigen::Vector2d centre(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    distances.push_back((z * camera.unproject(centre) - *sample.hand_m).norm());
  }
  if (radii.empty())
    throw data_error(fmt::format("hand boxes of the clips with '{}' contain no hand", object),
                     "draw the box on the hand, in each clip's first frame");
  return {median(radii), std::sqrt(uneven_m2 / static_cast<double>(radii.size())),
          median(std::move(distances))};
}

/// High quantile over the sightings of the visible fraction of the object's disc.
double visible_disc_fraction(const SceneModel& model, const std::vector<Sighting>& sightings,
                             double radius_m) {
  std::vector<double> fractions{0.0};
  for (const auto& [frame, patch, box] : sightings)
    fractions.push_back(static_cast<double>(patch.points_m.size()) /
                        model.segmenter.disc_pixels(radius_m, patch.centroid_m.z()));
  return quantile(std::move(fractions), high_quantile);
}

/// Visible fraction of the part of a sphere's disc that no background is seen through.
double visible_sphere_fraction(const SceneModel& model, const RgbdFrame& frame, const Patch& patch,
                               double radius_m) {
  return static_cast<double>(patch.points_m.size()) /
         (model.segmenter.disc_pixels(radius_m, patch.centroid_m.z()) *
          model.occluded_fraction(frame, patch.centroid_m, radius_m));
}

/// At most `max_count` sightings, evenly spread.
std::vector<const Sighting*> spread(const std::vector<const Sighting*>& sightings,
                                    std::size_t max_count) {
  const std::size_t stride = ceil_div(sightings.size(), max_count);
  std::vector<const Sighting*> some;
  for (std::size_t i = 0; i < sightings.size(); i += stride) some.push_back(sightings[i]);
  return some;
}

/// Sightings for shape learning. Those with boxes have a quota of their own: they are few in a long
/// recording, and nothing else shows what the hand always hides.
std::vector<const Sighting*> select_sightings(const std::vector<Sighting>& sightings) {
  std::vector<const Sighting*> boxed, others;
  for (const auto& sighting : sightings) (sighting.box ? boxed : others).push_back(&sighting);
  auto some = spread(boxed, max_boxed_views);
  std::ranges::copy(spread(others, max_other_views), std::back_inserter(some));
  return some;
}

/// Shape from the sightings, or a sphere as large as the boxes if the hand hides most of the
/// object.
ObjectShape shape_from(const SceneModel& model, const FrameSource& frames,
                       const std::string& object, const std::vector<Sighting>& sightings,
                       const BoxedObject& boxed, int num_threads) {
  std::vector<double> radii;
  for (const auto& sighting : sightings) radii.push_back(silhouette_radius_m(sighting.patch));
  const double silhouette_m = quantile(std::move(radii), high_quantile);
  const auto some = select_sightings(sightings);
  std::vector<BodyView> views(some.size());
  std::vector<double> fractions(views.size());
  parallel_for(views.size(), num_threads, [&](std::size_t i) {
    const auto& [index, patch, box] = *some[i];
    const auto frame = frames.camera_frame(index);
    fractions[i] = visible_sphere_fraction(model, frame, patch, boxed.radius_m);
    views[i] = model.view_object(frame, object, patch, view_reach_silhouettes * silhouette_m, true);
    views[i].pixel_angular_size = model.segmenter.pixel_angular_size_rad();
    if (box) views[i].box = box_planes(model.segmenter.color_camera(), *box, patch.centroid_m);
  });
  const double fraction = quantile(std::move(fractions), high_quantile);
  if (fraction < min_shape_fraction) return boxed.sphere();
  const auto shape = learn_shape(views, silhouette_m, num_threads);
  return fraction < min_sphere_fraction && !shape.body ? boxed.sphere() : shape;
}

/// Sightings of an object of the hand's colour, in frames where the two are apart.
std::vector<Sighting> sightings_apart_from_hand(const SceneModel& model, const std::string& object,
                                                SampledFrames& samples, const BoxedObject& boxed) {
  for (auto& sample : samples)
    if (sample.hand_m) model.split_object(sample.surface, object, *sample.hand_m);
  return sightings_of(samples, boxed);
}

}  // namespace

void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  std::vector<SampledFrame>& samples, int num_threads) {
  auto& colors = model.colors[object];
  for (auto& sample : samples) {
    if (sample.index == sample.clip->first) learn_colors(sample, object, colors);
    std::erase_if(sample.surface,
                  [&](const SurfacePoint& p) { return !(p.position_m.z() < model.band_m); });
  }
  classify(colors, samples);
  const auto boxed = boxed_object(model, object, samples);
  const double min_sightings = min_visible_frames * static_cast<double>(samples.size());
  const auto is_visible = [&](const std::vector<Sighting>& sightings, double min_fraction) {
    return static_cast<double>(sightings.size()) >= min_sightings &&
           visible_disc_fraction(model, sightings, boxed.radius_m) >= min_fraction;
  };
  auto sightings = sightings_of(samples, boxed);
  if (!is_visible(sightings, 0.0)) {
    colors.learn_object_from(all_near_hand(samples, boxed));
    classify(colors, samples);
    sightings = sightings_of(samples, boxed);
    if (!is_visible(sightings, min_learnt_color_fraction)) sightings.clear();
  }
  if (sightings.empty()) {
    model.objects_with_hand_color.insert(object);
    colors.learn_object_from({});
    classify(colors, samples);
    model.object_shape[object] = boxed.sphere();
    sightings = sightings_apart_from_hand(model, object, samples, boxed);
  }
  if (!sightings.empty())
    model.object_shape[object] = shape_from(model, frames, object, sightings, boxed, num_threads);
}

}  // namespace touchtrace::label
