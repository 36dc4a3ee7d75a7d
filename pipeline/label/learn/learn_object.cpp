#include "pipeline/label/learn/learn_object.h"

#include <algorithm>
#include <cmath>

#include "engine/base/integer_math.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/box_planes.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_boxed_views = 16, max_other_views = 48;
constexpr double view_reach_silhouettes = 2.5;

/// Visible fraction of the part of a sphere's disc that no background is seen through.
double visible_sphere_fraction(const SceneModel& model, const RgbdFrame& frame, const Patch& patch,
                               double radius_m) {
  return static_cast<double>(patch.points_m.size()) /
         (model.segmenter->disc_pixels(radius_m, patch.centroid_m.z()) *
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

/// Views of an object for shape learning.
struct ShapeViews {
  std::vector<BodyView> views;
  double silhouette_m;  ///< radius
  double fraction;      ///< visible_sphere_fraction()
};

ShapeViews shape_views(const SceneModel& model, const FrameSource& frames,
                       const std::string& object, const std::vector<Sighting>& sightings,
                       double radius_m, int num_threads) {
  std::vector<double> radii;
  for (const auto& sighting : sightings) radii.push_back(silhouette_radius_m(sighting.patch));
  const double silhouette_m = quantile(std::move(radii), unhidden_quantile);
  const auto some = select_sightings(sightings);
  std::vector<BodyView> views(some.size());
  std::vector<double> fractions(views.size());
  parallel_for(views.size(), num_threads, [&](std::size_t i) {
    const auto& [index, patch, box] = *some[i];
    const auto frame = frames.camera_frame(index);
    fractions[i] = visible_sphere_fraction(model, frame, patch, radius_m);
    views[i] = model.view_object(frame, object, patch, view_reach_silhouettes * silhouette_m, true);
    views[i].pixel_angular_size = model.segmenter->pixel_angular_size_rad();
    if (box) views[i].box = box_planes(model.segmenter->color_camera(), *box, patch.centroid_m);
  });
  return {std::move(views), silhouette_m, quantile(std::move(fractions), unhidden_quantile)};
}

}  // namespace

void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  SampledFrames& samples, int num_threads) {
  const auto boxed = boxed_object(model.segmenter->color_camera(), object, samples);
  auto& shape = model.object_shape[object] = boxed.sphere();
  if (model.objects_with_hand_color.contains(object))
    for (auto& sample : samples)
      if (sample.hand_m) model.split_object(sample.surface, object, *sample.hand_m);
  const auto sightings = sightings_of(samples, boxed, num_threads);
  if (sightings.empty()) return;
  const auto seen = shape_views(model, frames, object, sightings, boxed.radius_m, num_threads);
  shape = learn_shape(seen.views, seen.silhouette_m, num_threads);
  if (!shape.body)
    shape.centre_sigma_m = hidden_sphere_centre_sigma_m(shape, seen.fraction, boxed.radius_m);
}

}  // namespace touchtrace::label
