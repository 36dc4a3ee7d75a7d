#include "pipeline/label/track/target.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr double max_box_shift = 0.4;  // of the box's size; more restarts the tracker
constexpr int lost_after_frames = 3;
constexpr std::size_t max_spread_starts = 16;
// Up to this distance from its expected position any part of a body is accepted. Farther away it is
// not held, so at least this fraction of its disc must be visible.
constexpr double expected_distance_m = 0.04, hinted_distance_m = 0.15, min_disc_fraction = 0.5;
constexpr double unlimited_m = 10.0;
constexpr double refound_distance_m = 2.0 * arm_reach_m;  // of a body that was hidden or lost
// Mean likeness of a patch, of a body that is lost or hidden and of one that is followed: colours
// rarer in the class than usual by so much (2 and 7 times) are another body's. Shadows and exposure
// pass in less than likeness_time_s; over it, colours are not rarer by more than the third.
constexpr double min_found_likeness = -0.7, min_likeness = -2.0, min_mean_likeness = -0.9;
constexpr double likeness_time_s = 0.5;
constexpr double max_disc_fill = 0.8;  // of the search disc; a body fills less than half of it

bool matches(const PixelBox& tracked, const PixelBox& found) {
  const double dx = tracked.x + 0.5 * tracked.width - found.x - 0.5 * found.width;
  const double dy = tracked.y + 0.5 * tracked.height - found.y - 0.5 * found.height;
  const double size = std::max(found.width, found.height);
  return std::hypot(dx, dy) < max_box_shift * size && tracked.width < 2 * size &&
         2 * tracked.width > found.width;
}

}  // namespace

bool Target::is_lost() const { return missed_frames_ >= lost_after_frames; }

double Target::gate_m() const { return is_lost() ? unlimited_m : filter_.gate_m(); }

Eigen::Vector3d Target::search_centre_m() const { return is_lost() ? last_m_ : predicted_m(); }

double Target::distance_scale_m() const { return is_lost() ? arm_reach_m : filter_.gate_m(); }

double Target::any_part_distance_m(bool has_hint) const {
  return is_lost() && has_hint ? hinted_distance_m : expected_distance_m;
}

double Target::max_distance_m() const {
  return is_hidden_ || is_lost() ? refound_distance_m : filter_.gate_m() + patch_radius_m_;
}

std::optional<Patch> Target::find_in_box(const Surface& surface, const PixelBox& box) const {
  const auto start =
      median_point(points_in(surface, box), body_, Eigen::Vector3d::Zero(), unlimited_m);
  return start ? find_patch(surface, body_, *start, patch_radius_m_, min_points_) : std::nullopt;
}

std::optional<PixelBox> Target::update_tracker(const MaskedImage& image, const Camera& camera) {
  if (!(predicted_m().z() > 0.1)) return std::nullopt;
  const auto pixel = camera.project(predicted_m());
  return tracker_.update(image, pixel.x(), pixel.y());
}

std::vector<Eigen::Vector3d> Target::starts(const Surface& own,
                                            const std::optional<PixelBox>& tracked_box,
                                            const std::optional<Eigen::Vector3d>& hint_m) const {
  std::vector<Eigen::Vector3d> result{predicted_m()};
  if (hint_m) result.push_back(*hint_m);
  if (tracked_box)
    if (const auto median =
            median_point(points_in(own, *tracked_box), body_, predicted_m(), gate_m()))
      result.push_back(*median);
  if (const auto median = median_point(own, body_, predicted_m(), gate_m()))
    result.push_back(*median);
  if (!is_hidden_ && !is_lost()) return result;
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / max_spread_starts)
    result.push_back(own[i].position_m.cast<double>());
  return result;
}

std::optional<Patch> Target::find(const Surface& surface, const MaskedImage& image,
                                  const std::optional<PixelBox>& tracked_box,
                                  const Segmenter& segmenter,
                                  const std::optional<Eigen::Vector3d>& hint_m) {
  const Surface own = points_of(surface, body_);
  const auto patch = best_patch(own, segmenter, starts(own, tracked_box, hint_m), hint_m);
  if (!patch || !is_usual(*patch)) {
    tracker_.stop();
    ++missed_frames_;
    return std::nullopt;
  }
  if (!(tracked_box && matches(*tracked_box, patch->box))) restart_tracker(image, patch->box);
  return patch;
}

bool Target::is_usual(const Patch& patch) {
  const double weight = std::min(1.0, since_find_s_ / likeness_time_s);
  mean_likeness_ += weight * (patch.likeness - mean_likeness_);
  since_find_s_ = 0.0;
  if (mean_likeness_ > min_mean_likeness) return true;
  lose();
  return false;
}

void Target::lose() {
  tracker_.stop();
  mean_likeness_ = 0.0;
  missed_frames_ = std::max(missed_frames_, lost_after_frames);
}

std::optional<Patch> Target::best_patch(const Surface& own, const Segmenter& segmenter,
                                        const std::vector<Eigen::Vector3d>& starts,
                                        const std::optional<Eigen::Vector3d>& hint_m) const {
  std::optional<Patch> best;
  double highest = -std::numeric_limits<double>::infinity();
  for (const auto& start : starts) {
    auto patch = find_patch(own, body_, start, patch_radius_m_, min_points_);
    if (!patch) continue;
    double distance_m = (patch->centroid_m - search_centre_m()).norm();
    if (hint_m) distance_m = std::min(distance_m, (patch->centroid_m - *hint_m).norm());
    const auto points = static_cast<double>(patch->points_m.size());
    const double depth_m = patch->centroid_m.z();
    const double disc = segmenter.disc_pixels(disc_radius_m_, depth_m);
    if (body_ == Body::hand && points < min_hand_fraction * disc) continue;
    if (patch->likeness < (is_hidden_ || is_lost() ? min_found_likeness : min_likeness) ||
        points > max_disc_fill * segmenter.disc_pixels(patch_radius_m_, depth_m))
      continue;
    if (distance_m > max_distance_m() ||
        (distance_m > any_part_distance_m(hint_m.has_value()) + patch_radius_m_ &&
         points < min_disc_fraction * disc))
      continue;
    const double score = patch_score(points, distance_m / distance_scale_m()) + patch->likeness;
    if (score > highest) highest = score, best = std::move(patch);
  }
  return best;
}

void Target::start(const Eigen::Vector3d& position_m, double sigma_m, const PixelBox& box,
                   const MaskedImage& image) {
  filter_.start(position_m, sigma_m);
  last_m_ = position_m;
  missed_frames_ = 0;
  if (!box.empty()) restart_tracker(image, box);
}

void Target::measure(const Eigen::Vector3d& position_m, double sigma_m) {
  if ((position_m - predicted_m()).norm() > filter_.gate_m() + patch_radius_m_)
    filter_.start(position_m, sigma_m);
  else
    filter_.measure(position_m, sigma_m);
  last_m_ = position_m;
  missed_frames_ = 0;
  is_hidden_ = false;
}

void Target::set_hidden(const Eigen::Vector3d& position_m, double sigma_m) {
  measure(position_m, sigma_m);
  is_hidden_ = true;
}

void Target::restart_tracker(const MaskedImage& image, const PixelBox& box) {
  tracker_.start(image, {box.x - 1, box.y - 1, box.width + 2, box.height + 2});
}

}  // namespace touchtrace::label
