#include "pipeline/label/learn/sightings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/box_planes.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t min_patch_points = 12, max_patch_starts = 16;
constexpr double toss_m = 0.5;  // points farther from the hand are not the object
/// Error of a sphere's centre along an image axis over half the RMS difference of half width and
/// half height, for a randomly rotated ellipsoid of which the part within 60 degrees of the line of
/// sight is visible.
constexpr double box_centre_per_unevenness = 1.44;
/// RMS error over the axes per radius: the half extent along the line of sight, which no box shows,
/// is taken for evenly distributed from 0.3 to 1.5 radii.
constexpr double box_centre_per_radius = 0.2;

double patch_points(const Patch& patch) { return static_cast<double>(patch.points_m.size()); }

/// Patch of a class with the largest score over starts spread over its points.
template <class Score>
std::optional<Patch> best_patch(const Surface& surface, Body body, double radius_m, Score&& score) {
  const Surface own = points_of(surface, body);
  std::optional<Patch> best;
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / max_patch_starts) {
    auto patch =
        find_patch(own, body, own[i].position_m.cast<double>(), radius_m, min_patch_points);
    if (patch && (!best || score(*patch) > score(*best))) best = std::move(patch);
  }
  return best;
}

std::optional<Eigen::Vector3d> centroid(const std::optional<Patch>& patch) {
  return patch ? std::optional(patch->centroid_m) : std::nullopt;
}

}  // namespace

ObjectShape BoxedObject::sphere() const {
  return {radius_m, std::nullopt, unevenness_m,
          std::hypot(box_centre_per_unevenness * unevenness_m, box_centre_per_radius * radius_m)};
}

void find_hands(SampledFrames& samples, int num_threads) {
  std::map<const ClipFrames*, std::optional<Eigen::Vector3d>> boxed;
  for (const auto& sample : samples)
    if (sample.has_boxes())
      boxed[sample.clip] = centroid(best_patch(points_in(sample.surface, sample.clip->hand_box),
                                               Body::hand, hand_patch_radius_m, patch_points));
  parallel_for(samples.size(), num_threads, [&](std::size_t i) {
    SampledFrame& sample = samples[i];
    const auto found = boxed.find(sample.clip);
    const auto start = found == boxed.end() ? std::nullopt : found->second;
    sample.hand_m = sample.has_boxes() ? start : std::nullopt;
    if (sample.has_boxes() || !start) return;
    sample.hand_m = centroid(
        best_patch(sample.surface, Body::hand, hand_patch_radius_m, [&](const Patch& patch) {
          return patch_score(patch_points(patch), (patch.centroid_m - *start).norm() / arm_reach_m);
        }));
  });
}

BoxedObject boxed_object(const Camera& color, const std::string& object,
                         const SampledFrames& samples) {
  std::vector<double> radii, distances;
  double uneven_m2 = 0.0;
  for (const auto& sample : samples) {
    const auto& box = sample.clip->object_box;
    if (!sample.has_boxes() || !sample.hand_m) continue;
    const double z = sample.hand_m->z(), half_pixel_m = 0.5 * z / color.fx;
    radii.push_back(half_pixel_m * std::sqrt(static_cast<double>(box.width * box.height)));
    uneven_m2 += std::pow(half_pixel_m * 0.5 * (box.width - box.height), 2);
    distances.push_back((z * color.unproject(centre_px(box)) - *sample.hand_m).norm());
  }
  if (radii.empty()) {
    const bool are_masks = !samples.empty() && samples.front().clip->has_mask_boxes;
    throw data_error(fmt::format("hand {} of the clips with '{}' contain no hand",
                                 are_masks ? "masks" : "boxes", object),
                     are_masks ? "check the hand's number in the masks: touchtrace import --hand-id"
                               : "draw the box on the hand; run: touchtrace mark RECORDING");
  }
  return {median(radii), std::sqrt(uneven_m2 / static_cast<double>(radii.size())),
          median(std::move(distances))};
}

Surface near_hand(const SampledFrame& sample, const BoxedObject& boxed) {
  Surface near;
  if (sample.hand_m)
    std::ranges::copy_if(sample.surface, std::back_inserter(near), [&](const SurfacePoint& point) {
      return (point.position_m.cast<double>() - *sample.hand_m).norm() < boxed.from_hand_m + toss_m;
    });
  return near;
}

std::optional<Sighting> sighting_of(const SampledFrame& sample, const BoxedObject& boxed) {
  auto patch = best_patch(near_hand(sample, boxed), Body::object,
                          object_patch_radius_factor * boxed.radius_m, patch_points);
  if (!patch) return std::nullopt;
  return Sighting{sample.index, std::move(*patch),
                  sample.has_drawn_boxes() ? std::optional(sample.clip->object_box) : std::nullopt};
}

std::vector<Sighting> sightings_of(const SampledFrames& samples, const BoxedObject& boxed,
                                   int num_threads) {
  std::vector<std::optional<Sighting>> sightings(samples.size());
  parallel_for(samples.size(), num_threads,
               [&](std::size_t i) { sightings[i] = sighting_of(samples[i], boxed); });
  std::vector<Sighting> result;
  for (auto& sighting : sightings)
    if (sighting) result.push_back(std::move(*sighting));
  return result;
}

double visible_disc_fraction(const Segmenter& segmenter, const std::vector<Sighting>& sightings,
                             double radius_m) {
  std::vector<double> fractions{0.0};
  for (const auto& [frame, patch, box] : sightings)
    fractions.push_back(static_cast<double>(patch.points_m.size()) /
                        segmenter.disc_pixels(radius_m, patch.centroid_m.z()));
  return quantile(std::move(fractions), unhidden_quantile);
}

}  // namespace touchtrace::label
