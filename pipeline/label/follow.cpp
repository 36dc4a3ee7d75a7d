#include "pipeline/label/follow.h"

#include <cmath>

#include "engine/base/interrupt.h"
#include "pipeline/label/box_tracker.h"
#include "pipeline/label/lift.h"
#include "pipeline/label/target_filter.h"

namespace touchtrace::label {
namespace {

constexpr double hand_radius_m = 0.12, hand_sigma_m = 0.004, follow_sigma_m = 0.02;
constexpr double reach_m =
    0.07;  // an object so much farther from the hand than in the grip is away
constexpr double search_margin = 1.6;  // of the object's radius: what belongs to it
constexpr std::size_t fewest_hand = 30, fewest_object = 6;
constexpr double most_box_shift = 0.4;  // of a box's size, before its tracker is set anew

/// The box around a patch, as a tracker gets it.
PixelBox tracker_box(const PixelBox& box) {
  return {box.x - 1, box.y - 1, box.width + 2, box.height + 2};
}

bool agrees(const PixelBox& tracked, const PixelBox& seen) {
  const double dx = tracked.x + 0.5 * tracked.width - seen.x - 0.5 * seen.width;
  const double dy = tracked.y + 0.5 * tracked.height - seen.y - 0.5 * seen.height;
  const double size = std::max(seen.width, seen.height);
  return std::hypot(dx, dy) < most_box_shift * size && tracked.width < 2 * size &&
         2 * tracked.width > seen.width;
}

/// One body: its filter, its tracker, and how it is told from the rest.
class Target {
 public:
  Target(Body body, double radius_m, std::size_t fewest, TrackerKind kind)
      : body_(body), radius_m_(radius_m), fewest_(fewest), kind_(kind) {}

  TargetFilter filter;
  int restarts = 0;

  /// Where a user's box says it is.
  std::optional<Patch> begin(const Surface& surface, const PixelBox& box) {
    Surface inside;
    for (const auto& point : surface)
      if (contains(box, point)) inside.push_back(point);
    const auto start = median_point(inside, body_, Eigen::Vector3d::Zero(), 1e3);
    return start ? find_patch(surface, body_, *start, radius_m_, fewest_) : std::nullopt;
  }

  /// By the tracker's box where it is believed, else by colour and depth within the gate.
  std::optional<Patch> find(const Surface& surface, const MaskedImage& image,
                            const PinholeCamera& camera) {
    const Eigen::Vector3d expected = filter.position_m();
    auto start = median_point(surface, body_, expected, filter.gate_m());
    std::optional<PixelBox> tracked;
    if (kind_ == TrackerKind::csrt && expected.z() > 0.1) {
      const auto pixel = camera.project(expected);
      tracked = tracker_.update(image, pixel.x(), pixel.y());
      if (tracked)
        if (const auto in_box = median_in_box(surface, *tracked)) start = in_box;
    }
    if (!start) return lose();
    const auto patch = find_patch(surface, body_, *start, radius_m_, fewest_);
    if (!patch || (patch->centroid_m - expected).norm() > filter.gate_m() + radius_m_)
      return lose();
    if (kind_ == TrackerKind::csrt && !(tracked && agrees(*tracked, patch->box)))
      restart(image, patch->box);
    return patch;
  }

  void restart(const MaskedImage& image, const PixelBox& box) {
    tracker_.start(image, tracker_box(box));
    ++restarts;
  }

 private:
  std::optional<Eigen::Vector3d> median_in_box(const Surface& surface, const PixelBox& box) const {
    Surface inside;
    for (const auto& point : surface)
      if (point.body == body_ && contains(box, point)) inside.push_back(point);
    return median_point(inside, body_, filter.position_m(), filter.gate_m());
  }

  std::optional<Patch> lose() {
    tracker_.stop();
    return std::nullopt;
  }

  Body body_;
  double radius_m_;
  std::size_t fewest_;
  TrackerKind kind_;
  BoxTracker tracker_;
};

/// Deviation of a sphere's centre, by how much of it is seen; depth is known half as well.
Eigen::Vector3d object_sigma_m(double visible) {
  const double sigma = visible > 0.8   ? 0.0016
                       : visible > 0.6 ? 0.003
                       : visible > 0.4 ? 0.005
                                       : 0.01;
  return {sigma, sigma, 2.0 * sigma};
}

Observation observe_hand(const Patch& patch) {
  return {true,
          false,
          patch.centroid_m,
          {hand_sigma_m, hand_sigma_m, 1.5 * hand_sigma_m},
          patch.centroid_m,
          1.0,
          patch.box};
}

Observation observe_object(const Patch& patch, double radius_m, const PinholeCamera& camera) {
  const double visible = visible_part(patch, radius_m, camera);
  return {
      true,    false,    sphere_center(patch, radius_m), object_sigma_m(visible), patch.centroid_m,
      visible, patch.box};
}

/// Hand and object of one clip.
class Follower {
 public:
  Follower(const SceneModel& scene, const ClipFrames& clip, const Eigen::Vector3d& gravity,
           TrackerKind kind)
      : scene_(scene),
        clip_(clip),
        gravity_(gravity),
        kind_(kind),
        radius_m_(scene.object_radius_m.at(clip.object)),
        hand_(Body::hand, hand_radius_m, fewest_hand, kind),
        object_(Body::object, search_margin * radius_m_, fewest_object, kind) {}

  void step(const RgbdFrame& frame, double seconds, ClipTrack& track) {
    const auto surface = scene_.see(frame, clip_.object);
    const auto& camera = scene_.segmenter.color_camera();
    const auto image = kind_ == TrackerKind::csrt
                           ? masked_image(frame, surface, camera.width, camera.height)
                           : MaskedImage{};
    std::optional<Patch> hand, object;
    if (!started_) {
      hand = hand_.begin(surface, clip_.hand_box);
      object = object_.begin(surface, clip_.object_box);
    } else {
      hand_.filter.predict(seconds, false, gravity_);
      object_.filter.predict(seconds, away_, gravity_);
      hand = hand_.find(surface, image, camera);
      object = object_.find(surface, image, camera);
    }
    track.hand.push_back(hand ? observe_hand(*hand) : Observation{});
    track.object.push_back(object ? observe_object(*object, radius_m_, camera) : Observation{});
    take_in(track.hand.back(), track.object.back(), image);
  }

  int restarts() const { return hand_.restarts + object_.restarts; }

 private:
  /// Both filters get what was seen; an object hidden in the hand goes where the hand goes.
  void take_in(const Observation& hand, Observation& object, const MaskedImage& image) {
    if (!started_) {
      begin(hand, object, image);
      return;
    }
    if (hand.found) hand_.filter.measure(hand.position_m, hand_sigma_m);
    if (!object.found && hand.found && !away_) {
      object.found = object.follows_hand = true;
      object.position_m = hand.position_m + object_from_hand_m_;
      object.sigma_m.setConstant(follow_sigma_m);
    }
    if (object.found) object_.filter.measure(object.position_m, object.sigma_m.maxCoeff());
    if (hand.found && object.found && !object.follows_hand) {
      const Eigen::Vector3d apart = object.position_m - hand.position_m;
      away_ = apart.norm() > grip_m_ + reach_m;
      if (!away_) object_from_hand_m_ = apart;
    }
  }

  void begin(const Observation& hand, const Observation& object, const MaskedImage& image) {
    if (!hand.found || !object.found) return;
    hand_.filter.start(hand.position_m, hand_sigma_m);
    object_.filter.start(object.position_m, object.sigma_m.maxCoeff());
    object_from_hand_m_ = object.position_m - hand.position_m;
    grip_m_ = object_from_hand_m_.norm();
    if (kind_ == TrackerKind::csrt) {
      hand_.restart(image, hand.box);
      object_.restart(image, object.box);
    }
    started_ = true;
  }

  const SceneModel& scene_;
  const ClipFrames& clip_;
  Eigen::Vector3d gravity_, object_from_hand_m_ = Eigen::Vector3d::Zero();
  TrackerKind kind_;
  double radius_m_, grip_m_ = 0.0;
  Target hand_, object_;
  bool started_ = false, away_ = false;
};

constexpr double wholly_seen = 0.5;

/// In the grip little of the object shows and a sphere's fit is noisy, but always the same part
/// shows: there the centroid plus the grasp's median of (fit - centroid) is steadier.
void steady_in_grip(std::vector<Observation>& object) {
  std::array<std::vector<double>, 3> offsets;
  const auto is_partial = [](const Observation& o) {
    return o.found && !o.follows_hand && o.visible < wholly_seen;
  };
  for (const auto& o : object)
    for (std::size_t axis = 0; is_partial(o) && axis < 3; ++axis)
      offsets[axis].push_back((o.position_m - o.surface_m)[static_cast<Eigen::Index>(axis)]);
  if (offsets[0].empty()) return;
  Eigen::Vector3d offset;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto middle =
        offsets[axis].begin() + static_cast<std::ptrdiff_t>(offsets[axis].size() / 2);
    std::nth_element(offsets[axis].begin(), middle, offsets[axis].end());
    offset[static_cast<Eigen::Index>(axis)] = *middle;
  }
  for (auto& o : object)
    if (is_partial(o)) o.position_m = o.surface_m + offset;
}

}  // namespace

ClipTrack follow(const SceneModel& scene, const FrameSource& frames, const ClipFrames& clip,
                 const std::vector<double>& frame_time_s, const Eigen::Vector3d& gravity_m_per_s2,
                 TrackerKind tracker) {
  Follower follower(scene, clip, gravity_m_per_s2, tracker);
  ClipTrack track;
  for (std::size_t i = clip.first; i < clip.first + clip.count; ++i) {
    throw_if_interrupted();
    const double seconds = i > clip.first ? frame_time_s[i] - frame_time_s[i - 1] : 0.0;
    follower.step(frames.camera_frame(i), seconds, track);
    track.time_s.push_back(frame_time_s[i]);
  }
  steady_in_grip(track.object);
  track.restarts = follower.restarts();
  return track;
}

}  // namespace touchtrace::label
