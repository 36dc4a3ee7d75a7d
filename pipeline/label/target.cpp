#include "pipeline/label/target.h"

#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr double most_box_shift = 0.4;  // of a box's size, before its tracker is set anew
constexpr int frames_to_be_lost = 3;
constexpr std::size_t starts_everywhere = 16;
// So far from where a body is expected it may be found by any part of it; beyond, it is in the open
// and shows that part of a disc.
constexpr double foreseen_m = 0.04, hinted_m = 0.15, shown_far_away = 0.5;
constexpr double everywhere_m = 10.0, reach_of_an_arm_m = 0.7;
constexpr double most_filled = 0.8;  // of the circle it was cut with; no body fills half of its own

bool agrees(const PixelBox& tracked, const PixelBox& seen) {
  const double dx = tracked.x + 0.5 * tracked.width - seen.x - 0.5 * seen.width;
  const double dy = tracked.y + 0.5 * tracked.height - seen.y - 0.5 * seen.height;
  const double size = std::max(seen.width, seen.height);
  return std::hypot(dx, dy) < most_box_shift * size && tracked.width < 2 * size &&
         2 * tracked.width > seen.width;
}

}  // namespace

bool Target::is_lost() const { return missed_ >= frames_to_be_lost; }

double Target::gate_m() const { return is_lost() ? everywhere_m : filter_.gate_m(); }

Eigen::Vector3d Target::around_m() const { return is_lost() ? last_m_ : expected_m(); }

double Target::usual_off_m() const { return is_lost() ? reach_of_an_arm_m : filter_.gate_m(); }

double Target::near_m(bool hinted) const { return is_lost() && hinted ? hinted_m : foreseen_m; }

double Target::farthest_m() const {
  return hidden_ || is_lost() ? everywhere_m : filter_.gate_m() + radius_m_;
}

std::optional<Patch> Target::begin(const Surface& surface, const PixelBox& box) const {
  Surface inside;
  for (const auto& point : surface)
    if (contains(box, point)) inside.push_back(point);
  const auto start = median_point(inside, body_, Eigen::Vector3d::Zero(), everywhere_m);
  return start ? find_patch(surface, body_, *start, radius_m_, fewest_) : std::nullopt;
}

std::optional<PixelBox> Target::track(const MaskedImage& image, const Camera& camera) {
  if (!(expected_m().z() > 0.1)) return std::nullopt;
  const auto pixel = camera.project(expected_m());
  return tracker_.update(image, pixel.x(), pixel.y());
}

Surface Target::own_points(const Surface& surface) const {
  Surface own;
  std::ranges::copy_if(surface, std::back_inserter(own),
                       [&](const SurfacePoint& point) { return point.body == body_; });
  return own;
}

std::vector<Eigen::Vector3d> Target::starts(const Surface& own,
                                            const std::optional<PixelBox>& tracked,
                                            const std::optional<Eigen::Vector3d>& hint_m) const {
  std::vector<Eigen::Vector3d> result{expected_m()};
  if (hint_m) result.push_back(*hint_m);
  if (tracked)
    if (const auto in_box = median_in_box(own, *tracked)) result.push_back(*in_box);
  if (const auto middle = median_point(own, body_, expected_m(), gate_m()))
    result.push_back(*middle);
  if (!hidden_ && !is_lost()) return result;
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / starts_everywhere)
    result.push_back(own[i].position_m.cast<double>());
  return result;
}

std::optional<Patch> Target::find(const Surface& surface, const MaskedImage& image,
                                  const std::optional<PixelBox>& tracked,
                                  const Segmenter& segmenter,
                                  const std::optional<Eigen::Vector3d>& hint_m) {
  const Surface own = own_points(surface);
  const auto patch = best_patch(own, segmenter, starts(own, tracked, hint_m), hint_m);
  if (!patch) {
    tracker_.stop();
    ++missed_;
    return std::nullopt;
  }
  if (!(tracked && agrees(*tracked, patch->box))) restart(image, patch->box);
  return patch;
}

std::optional<Patch> Target::best_patch(const Surface& own, const Segmenter& segmenter,
                                        const std::vector<Eigen::Vector3d>& starts,
                                        const std::optional<Eigen::Vector3d>& hint_m) const {
  std::optional<Patch> best;
  double highest = -std::numeric_limits<double>::infinity();
  for (const auto& start : starts) {
    auto patch = find_patch(own, body_, start, radius_m_, fewest_);
    if (!patch) continue;
    double off = (patch->centroid_m - around_m()).norm();
    if (hint_m) off = std::min(off, (patch->centroid_m - *hint_m).norm());
    const auto points = static_cast<double>(patch->points_m.size());
    const double depth_m = patch->centroid_m.z();
    const double disc = segmenter.disc_pixels(disc_m_, depth_m);
    if (points > most_filled * segmenter.disc_pixels(radius_m_, depth_m)) continue;
    if (off > farthest_m() ||
        (off > near_m(hint_m.has_value()) + radius_m_ && points < shown_far_away * disc))
      continue;
    const double score = std::log(points) - 8.0 * std::pow(off / usual_off_m(), 2);
    if (score > highest) highest = score, best = std::move(patch);
  }
  return best;
}

void Target::start(const Eigen::Vector3d& position_m, double sigma_m, const PixelBox& box,
                   const MaskedImage& image) {
  filter_.start(position_m, sigma_m);
  last_m_ = position_m;
  missed_ = 0;
  if (!box.empty()) restart(image, box);
}

void Target::measure(const Eigen::Vector3d& position_m, double sigma_m) {
  if ((position_m - expected_m()).norm() > filter_.gate_m() + radius_m_)
    filter_.start(position_m, sigma_m);
  else
    filter_.measure(position_m, sigma_m);
  last_m_ = position_m;
  missed_ = 0;
  hidden_ = false;
}

void Target::hide(const Eigen::Vector3d& position_m, double sigma_m) {
  measure(position_m, sigma_m);
  hidden_ = true;
}

std::optional<Eigen::Vector3d> Target::median_in_box(const Surface& own,
                                                     const PixelBox& box) const {
  Surface inside;
  for (const auto& point : own)
    if (contains(box, point)) inside.push_back(point);
  return median_point(inside, body_, expected_m(), gate_m());
}

void Target::restart(const MaskedImage& image, const PixelBox& box) {
  tracker_.start(image, {box.x - 1, box.y - 1, box.width + 2, box.height + 2});
}

}  // namespace touchtrace::label
