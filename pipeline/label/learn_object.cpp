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
#include "pipeline/label/marked_sides.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t fewest_points = 12, most_starts = 16, most_marked = 16, most_others = 48;
constexpr double toss_m = 0.5, shown_in_some_frames = 0.4, shown_at_all = 0.25, shown_well = 0.5;
constexpr double silhouette_quantile = 0.8, around_radii = 2.5;
constexpr double often = 0.1;  // of the sampled frames: so seldom is an object wholly hidden

using SampledFrames = std::vector<SampledFrame>;

double quantile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// The object in one of the sampled frames.
struct Sighting {
  std::size_t frame;
  Patch patch;
  std::optional<PixelBox> marked;  ///< on all of it, in a clip's first frame
};

/// The largest patch of a body, looked for from points all over it.
std::optional<Patch> largest_patch(const Surface& surface, Body body, double radius_m) {
  Surface own;
  std::ranges::copy_if(surface, std::back_inserter(own),
                       [&](const SurfacePoint& point) { return point.body == body; });
  std::optional<Patch> largest;
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / most_starts) {
    auto patch = find_patch(own, body, own[i].position_m.cast<double>(), radius_m, fewest_points);
    if (patch && (!largest || patch->points_m.size() > largest->points_m.size()))
      largest = std::move(patch);
  }
  return largest;
}

std::optional<Eigen::Vector3d> find_hand(const Surface& surface) {
  const auto patch = largest_patch(surface, Body::hand, hand_patch_radius_m);
  return patch ? std::optional(patch->centroid_m) : std::nullopt;
}

/// Of an ellipsoid that is turned at random: how far off, along an axis of the image, the middle
/// comes out that is seen of its part within 60 degrees of the ray to it, for half the RMS
/// difference of its half width and half height.
constexpr double middle_per_unevenness_of_boxes = 1.44;

/// What the clips' boxes say of the object: about how large it is, how far from that its half width
/// and height are (RMS), and how far it is from the hand.
struct Boxed {
  double radius_m, uneven_m, from_hand_m;

  ObjectShape sphere() const {
    return {radius_m, std::nullopt, uneven_m, middle_per_unevenness_of_boxes * uneven_m};
  }
};

/// What moves within a toss of where the hand has the object; nothing if no hand is seen.
Surface near_hand(const SampledFrame& sample, const Boxed& boxed) {
  Surface near;
  if (sample.hand_m)
    std::ranges::copy_if(sample.surface, std::back_inserter(near), [&](const SurfacePoint& point) {
      return (point.position_m.cast<double>() - *sample.hand_m).norm() < boxed.from_hand_m + toss_m;
    });
  return near;
}

std::optional<PixelBox> marked_box(const SampledFrame& sample) {
  return sample.index == sample.clip->first ? std::optional(sample.clip->object_box) : std::nullopt;
}

std::vector<Sighting> sightings_of(const SampledFrames& samples, const Boxed& boxed) {
  std::vector<Sighting> result;
  for (const auto& sample : samples)
    if (auto patch = largest_patch(near_hand(sample, boxed), Body::object,
                                   object_patch_radii * boxed.radius_m))
      result.push_back({sample.index, std::move(*patch), marked_box(sample)});
  return result;
}

void learn_colors(const SampledFrame& first, const std::string& object, ColorClasses& colors) {
  const auto& [hand_box, object_box] = std::tie(first.clip->hand_box, first.clip->object_box);
  if (std::ranges::none_of(first.surface, [&](const auto& p) { return contains(object_box, p); }))
    throw data_error(fmt::format("nothing but background is in the box on the object '{}' in "
                                 "camera frame {}",
                                 object, first.index),
                     "give object boxes that lie on the object in each clip's first frame");
  colors.learn(first.surface, hand_box, object_box);
}

void classify(ColorClasses& colors, SampledFrames& samples) {
  colors.settle();
  for (auto& sample : samples) {
    colors.assign(sample.surface);
    sample.hand_m = find_hand(sample.surface);
  }
}

Surface all_near_hand(const SampledFrames& samples, const Boxed& boxed) {
  Surface all;
  for (const auto& sample : samples)
    std::ranges::copy(near_hand(sample, boxed), std::back_inserter(all));
  return all;
}

/// Over the clips whose first frame shows the hand; medians of a disc as large as the object's box,
/// at the hand's distance.
Boxed boxed_object(const SceneModel& model, const std::string& object,
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
    const Eigen::Vector2d middle(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    distances.push_back((z * camera.unproject(middle) - *sample.hand_m).norm());
  }
  if (radii.empty())
    throw data_error(fmt::format("no hand was found in the boxes of the clips with '{}'", object),
                     "give boxes that lie on the hand in each clip's first frame");
  return {median(radii), std::sqrt(uneven_m2 / static_cast<double>(radii.size())),
          median(std::move(distances))};
}

/// The part of its disc that an object shows where it shows most.
double shown(const SceneModel& model, const std::vector<Sighting>& sightings, double radius_m) {
  std::vector<double> parts{0.0};
  for (const auto& [frame, patch, marked] : sightings)
    parts.push_back(static_cast<double>(patch.points_m.size()) /
                    model.segmenter.disc_pixels(radius_m, patch.centroid_m.z()));
  return quantile(std::move(parts), silhouette_quantile);
}

/// The part that shows of a sphere of `radius_m` but for what is seen past it.
double shown_of(const SceneModel& model, const RgbdFrame& frame, const Patch& patch,
                double radius_m) {
  return static_cast<double>(patch.points_m.size()) /
         (model.segmenter.disc_pixels(radius_m, patch.centroid_m.z()) *
          model.hidden_part(frame, patch.centroid_m, radius_m));
}

/// At most so many, spread evenly.
std::vector<const Sighting*> spread(const std::vector<const Sighting*>& sightings,
                                    std::size_t most) {
  const std::size_t stride = ceil_div(sightings.size(), most);
  std::vector<const Sighting*> some;
  for (std::size_t i = 0; i < sightings.size(); i += stride) some.push_back(sightings[i]);
  return some;
}

/// Those in which all of the object is marked are few in a long recording, and nothing else tells
/// what the hand always hides: they are chosen by themselves.
std::vector<const Sighting*> some_of(const std::vector<Sighting>& sightings) {
  std::vector<const Sighting*> marked, others;
  for (const auto& sighting : sightings) (sighting.marked ? marked : others).push_back(&sighting);
  auto some = spread(marked, most_marked);
  std::ranges::copy(spread(others, most_others), std::back_inserter(some));
  return some;
}

/// Through what is seen of the object and beside what is seen past it; of a sphere that a hand
/// hides for the most part, as large as the object's boxes say.
ObjectShape object_shape(const SceneModel& model, const FrameSource& frames,
                         const std::string& object, const std::vector<Sighting>& sightings,
                         const Boxed& boxed, int threads) {
  std::vector<double> radii;
  for (const auto& sighting : sightings) radii.push_back(silhouette_radius_m(sighting.patch));
  const double silhouette_m = quantile(std::move(radii), silhouette_quantile);
  const auto some = some_of(sightings);
  std::vector<BodyView> views(some.size());
  std::vector<double> parts(views.size());
  parallel_for(views.size(), threads, [&](std::size_t i) {
    const auto& [index, patch, marked] = *some[i];
    const auto frame = frames.camera_frame(index);
    parts[i] = shown_of(model, frame, patch, boxed.radius_m);
    views[i] = model.view_body(frame, object, patch, around_radii * silhouette_m, true);
    views[i].looks_beside = model.segmenter.pixel_rad();
    if (marked)
      views[i].marked = marked_sides(model.segmenter.color_camera(), *marked, patch.centroid_m);
  });
  const double part = quantile(std::move(parts), silhouette_quantile);
  if (part < shown_at_all) return boxed.sphere();
  const auto shape = learn_shape(views, silhouette_m, threads);
  return part < shown_well && !shape.body ? boxed.sphere() : shape;
}

/// Sightings of an object like the hand: while they are apart.
std::vector<Sighting> look_beside_the_hand(const SceneModel& model, const std::string& object,
                                           SampledFrames& samples, const Boxed& boxed) {
  for (auto& sample : samples)
    if (sample.hand_m) model.split(sample.surface, object, *sample.hand_m);
  return sightings_of(samples, boxed);
}

}  // namespace

void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  std::vector<SampledFrame>& samples, int threads) {
  auto& colors = model.colors[object];
  for (auto& sample : samples) {
    if (sample.index == sample.clip->first) learn_colors(sample, object, colors);
    std::erase_if(sample.surface,
                  [&](const SurfacePoint& p) { return !(p.position_m.z() < model.band_m); });
  }
  classify(colors, samples);
  const auto boxed = boxed_object(model, object, samples);
  const double enough = often * static_cast<double>(samples.size());
  const auto is_told = [&](const std::vector<Sighting>& sightings, double part) {
    return static_cast<double>(sightings.size()) >= enough &&
           shown(model, sightings, boxed.radius_m) >= part;
  };
  auto sightings = sightings_of(samples, boxed);
  if (!is_told(sightings, 0.0)) {
    colors.learn_object_from(all_near_hand(samples, boxed));
    classify(colors, samples);
    sightings = sightings_of(samples, boxed);
    if (!is_told(sightings, shown_in_some_frames)) sightings.clear();
  }
  if (sightings.empty()) {
    model.like_the_hand.insert(object);
    colors.learn_object_from({});
    classify(colors, samples);
    model.object_shape[object] = boxed.sphere();
    sightings = look_beside_the_hand(model, object, samples, boxed);
  }
  if (!sightings.empty())
    model.object_shape[object] = object_shape(model, frames, object, sightings, boxed, threads);
}

}  // namespace touchtrace::label
