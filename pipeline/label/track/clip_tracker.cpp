#include "pipeline/label/track/clip_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "engine/base/interrupt.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/box_planes.h"
#include "pipeline/label/observe/lift.h"
#include "pipeline/label/observe/mask_observer.h"
#include "pipeline/label/track/box_tracker.h"
#include "pipeline/label/track/grip.h"
#include "pipeline/label/track/object_estimator.h"
#include "pipeline/label/track/other_bodies.h"
#include "pipeline/label/track/target_filter.h"

namespace touchtrace::label {
namespace {

// Standard deviations of a hidden object's position for the filter: from the hand; from the first
// box.
constexpr double in_hand_sigma_m = 0.02, first_box_sigma_m = 0.03;
constexpr double min_occluded_fraction = 0.5;  // of a hidden object's rays
constexpr double released_m = 0.07;          // grown distance to the hand of an object that left it
constexpr double max_unseen_flight_s = 1.0;  // an object unseen for longer has been caught
constexpr std::size_t min_hand_points = 30, min_object_points = 6;
constexpr std::size_t max_hand_points = 50;  // kept of a frame
/// Median distance from the object's surface of points that are part of it. Where the object was
/// taken for the hand in five public recordings it was 1 to 8 mm (real_recordings.md). In
/// eight simulated recordings, and at the references of seventeen public ones, it costs no hand.
constexpr double max_on_object_m = 0.006;

/// Median of each value and of two on either side.
std::vector<double> running_median(const std::vector<double>& values) {
  constexpr std::ptrdiff_t reach = 2;
  std::vector<double> medians;
  for (auto at = values.begin(); at != values.end(); ++at)
    medians.push_back(median({at - std::min(reach, at - values.begin()),
                              at + 1 + std::min(reach, values.end() - at - 1)}));
  return medians;
}

class ClipTracker {
 public:
  ClipTracker(const SceneModel& scene, FramePrefetcher::Reader& frames, const ClipFrames& clip,
              const Eigen::Vector3d& gravity, const TrackerKind& kind)
      : scene_(scene),
        frames_(frames),
        clip_(clip),
        gravity_(gravity),
        shape_(scene.object_shape.at(clip.object)),
        estimator_(scene, clip),
        hand_(Body::hand, hand_disc_radius_m, hand_patch_radius_m, min_hand_points, kind),
        object_(Body::object, shape_.radius_m, object_patch_radius_factor * shape_.radius_m,
                min_object_points, kind) {
    if (!scene.objects_with_hand_color.contains(clip.object) && scene.only_masked_body != mask_hand)
      others_.emplace(*scene.segmenter, scene.depth_noise_at_1m);
  }

  void step(SegmentedFrame segmented, double seconds, ClipTrack& track) {
    auto& [frame, surface, image] = segmented;
    const bool has_hand_mask = is_masked(frame, mask_hand);
    if (is_started_ && !others_) scene_.split_object(surface, clip_.object, hand_.predicted_m());
    const auto [hand, object] =
        is_started_ ? find_in_next_frame(segmented, seconds) : find_in_first_frame(segmented);
    const std::size_t index = track.hand.size();
    track.hand.push_back(hand ? observe_hand(*hand) : Observation{});
    unseen_s_ += seconds;
    track.object.push_back(
        object ? estimator_.observe(frame, index, *object, std::exchange(unseen_s_, 0.0))
               : Observation{});
    update(track.hand.back(), track.object.back(), frame, image);
    // boxes and masks show where the hand ends
    const bool is_shown = index == 0 || scene_.has_all_masks || has_hand_mask;
    if (hand && !is_shown && is_on_arm(*hand, surface)) track.hand.back() = {};
    if (hand && !is_shown) hand_points_m_[index] = every_nth(hand->points_m, max_hand_points);
  }

  /// Observations of the object, given all frames. Where they show that a part of its surface was
  /// taken for the hand, the hand is lost.
  void smooth_poses(ClipTrack& track) {
    estimator_.smooth_poses(track.object);
    std::vector<std::size_t> frames;
    std::vector<double> distances_m;
    for (const auto& [index, points_m] : hand_points_m_)
      if (const auto distance_m = estimator_.median_distance_m(index, points_m))
        frames.push_back(index), distances_m.push_back(*distance_m);
    const auto medians_m = running_median(distances_m);
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (medians_m[i] < max_on_object_m) track.hand[frames[i]] = {};
  }

  int tracker_starts() const { return hand_.tracker_starts() + object_.tracker_starts(); }

 private:
  struct Found {
    std::optional<Patch> hand, object;
  };

  /// Whether the frame has masks that show the body.
  bool is_masked(const RgbdFrame& frame, MaskValue body) const {
    const MaskValue other = body == mask_hand ? mask_object : mask_hand;
    return scene_.has_some_masks && !frame.mask.empty() && scene_.only_masked_body != other;
  }

  /// A box excludes the other hand and the bare arm.
  Found find_in_first_frame(SegmentedFrame& segmented) {
    auto& [frame, surface, image] = segmented;
    Found found;
    if (is_masked(frame, mask_hand)) {
      found.hand = find_masked_hand(frame, surface, image, {});
    } else {
      found.hand = hand_.find_in_box(points_in(surface, clip_.hand_box), clip_.hand_box);
      if (found.hand && others_)
        others_->start(surface, clip_.hand_box, clip_.object_box, *found.hand);
    }
    found.object = object_.find_in_box(surface, clip_.object_box);
    return found;
  }

  Found find_in_next_frame(SegmentedFrame& segmented, double seconds) {
    auto& [frame, surface, image] = segmented;
    hand_.predict(seconds, false, gravity_);
    object_.predict(seconds, is_away_, gravity_);
    const auto [hand_box, object_box] = update_trackers(image);
    Found found;
    found.hand = is_masked(frame, mask_hand) ? find_masked_hand(frame, surface, image, hand_box)
                                             : find_hand(surface, image, hand_box, seconds);
    if (found.hand && hand_.is_lost() && object_.is_lost()) assume_in_hand(*found.hand);
    found.object =
        object_.find(surface, image, object_box, *scene_.segmenter, position_in_hand(found.hand));
    if (!found.object && is_masked(frame, mask_object))
      found.object = object_.find_in_box(surface, mask_box(frame, mask_object, image_width()));
    return found;
  }

  /// Boxes of the image trackers on hand and object.
  std::array<std::optional<PixelBox>, 2> update_trackers(const MaskedImage& image) {
    const auto& camera = scene_.segmenter->color_camera();
    std::array<std::optional<PixelBox>, 2> boxes;
    frames_.run_in_parallel([&] { boxes[0] = hand_.update_tracker(image, camera); },
                            [&] { boxes[1] = object_.update_tracker(image, camera); });
    return boxes;
  }

  std::optional<Patch> find_hand(Surface& surface, const MaskedImage& image,
                                 const std::optional<PixelBox>& box, double seconds) {
    if (others_) others_->exclude_from(surface, seconds);
    auto hand = hand_.find(surface, image, box, *scene_.segmenter, std::nullopt);
    if (!others_ || others_->update(hand)) return hand;
    hand_.lose();
    return std::nullopt;
  }

  int image_width() const { return scene_.segmenter->color_camera().width; }

  /// Finds the hand among the mask's points, which no other body has. Other points of its
  /// colour belong to other bodies and become `rest`.
  std::optional<Patch> find_masked_hand(const RgbdFrame& frame, Surface& surface,
                                        const MaskedImage& image,
                                        const std::optional<PixelBox>& box) {
    const Surface colored = surface;
    scene_.observer->classify(frame, clip_.object, surface);
    const PixelBox hand_box = mask_box(frame, mask_hand, image_width());
    std::optional<Patch> hand;
    if (is_started_) hand = hand_.find(surface, image, box, *scene_.segmenter, std::nullopt);
    if (!hand) hand = hand_.find_in_box(surface, hand_box);
    if (hand && others_)
      others_->start(colored, hand_box, mask_box(frame, mask_object, image_width()), *hand);
    return hand;
  }

  /// Position of the object if the hand holds it; nullopt if it has left the hand.
  std::optional<Eigen::Vector3d> position_in_hand(const std::optional<Patch>& hand) const {
    if (!hand || is_away_) return std::nullopt;
    return hand->centroid_m + grip_.object_from_hand_m();
  }

  /// After both were lost, the object is assumed to be in the hand again.
  void assume_in_hand(const Patch& hand) {
    is_away_ = false;
    object_.set_hidden(hand.centroid_m + grip_.object_from_hand_m(), first_box_sigma_m);
  }

  /// Updates filters, grip and is_away_. An object hidden in the hand moves with the hand.
  void update(const Observation& hand, Observation& object, const RgbdFrame& frame,
              const MaskedImage& image) {
    if (!is_started_) {
      start(hand, object, image);
      return;
    }
    if (hand.found) hand_.measure(hand.position_m, hand_sigma_m);
    if (!object.found && hand.found) {
      is_away_ = is_away_ && !is_back(hand);
      if (!is_away_) follow_hand(hand, frame, object);
    }
    if (object.follows_hand)
      object_.set_hidden(object.position_m, in_hand_sigma_m);
    else if (object.found)
      object_.measure(object.position_m, object.sigma_m.maxCoeff());
    if (hand.found && object.found && !object.follows_hand) {
      const Eigen::Vector3d offset = object.position_m - hand.position_m;
      is_away_ = offset.norm() > grip_.initial_distance_m() + released_m;
      if (!is_away_) grip_.add(offset);
    }
  }

  /// Whether an object that was away must be in the hand again.
  bool is_back(const Observation& hand) const {
    return unseen_s_ > max_unseen_flight_s || (object_.predicted_m() - hand.position_m).norm() <
                                                  grip_.initial_distance_m() + released_m;
  }

  /// Places an invisible object in the hand, if something occludes it there and it was not about to
  /// leave the image.
  void follow_hand(const Observation& hand, const RgbdFrame& frame, Observation& object) {
    if (!scene_.segmenter->is_in_image(object_.predicted_m())) return;
    // from the grip's offset towards the hand: the first position that is occluded
    for (const double part : {1.0, 0.67, 0.33, 0.0}) {
      const Eigen::Vector3d position = hand.position_m + part * grip_.object_from_hand_m();
      if (scene_.occluded_fraction(frame, position, shape_.radius_m) < min_occluded_fraction)
        continue;
      object = hidden_object_at(position);
      return;
    }
  }

  /// An object that is not visible in its first box is behind the visible part of the hand.
  void start(const Observation& hand, Observation& object, const MaskedImage& image) {
    if (!hand.found) return;
    hand_.start(hand.position_m, hand_sigma_m, hand.box, image);
    if (object.found)
      object_.start(object.position_m, object.sigma_m.maxCoeff(), object.box, image);
    else
      start_hidden(hand, object);
    grip_.add(object.position_m - hand.position_m);
    is_started_ = true;
  }

  void start_hidden(const Observation& hand, Observation& object) {
    const Eigen::Vector3d ray =
        scene_.segmenter->color_camera().unproject(centre_px(clip_.object_box));
    object = hidden_object_at((hand.position_m.z() + shape_.radius_m) * ray);
    object_.start(object.position_m, first_box_sigma_m, {}, {});
    object_.set_hidden(object.position_m, first_box_sigma_m);
  }

  const SceneModel& scene_;
  FramePrefetcher::Reader& frames_;
  const ClipFrames& clip_;
  Eigen::Vector3d gravity_;
  Grip grip_;
  const ObjectShape& shape_;
  ObjectEstimator estimator_;
  double unseen_s_ = 0.0;  ///< since the object was last visible
  Target hand_, object_;
  std::optional<OtherBodies> others_;  ///< null for an object of the hand's colour
  bool is_started_ = false, is_away_ = false;
  std::map<std::size_t, std::vector<Eigen::Vector3f>> hand_points_m_;  ///< of the pass, by frame
};

}  // namespace

ClipTrack track_pass(const SceneModel& scene, FramePrefetcher::Reader& frames,
                     const TrackingPass& pass, const std::vector<double>& frame_time_s,
                     const Eigen::Vector3d& gravity_m_per_s2, const TrackerKind& kind) {
  ClipTracker tracker(scene, frames, *pass.clip, gravity_m_per_s2, kind);
  ClipTrack track;
  for (std::size_t i = 0; i < pass.count(); ++i) {
    throw_if_interrupted();
    track.time_s.push_back(frame_time_s[pass.frame(i)]);
    // free fall is the same in both directions of time
    const double seconds = i > 0 ? std::abs(track.time_s[i] - track.time_s[i - 1]) : 0.0;
    tracker.step(frames.next(), seconds, track);
  }
  tracker.smooth_poses(track);
  track.object_centre_sigma_m = scene.object_shape.at(pass.clip->object).centre_sigma_m;
  track.tracker_starts = tracker.tracker_starts();
  return track;
}

ClipTrack join(ClipTrack backward, const ClipTrack& forward) {
  const auto prepend = [](auto& reversed, const auto& rest) {
    std::ranges::reverse(reversed);
    reversed.pop_back();  // the box frame, also in `forward`
    reversed.insert(reversed.end(), rest.begin(), rest.end());
  };
  prepend(backward.time_s, forward.time_s);
  prepend(backward.hand, forward.hand);
  prepend(backward.object, forward.object);
  backward.tracker_starts += forward.tracker_starts;
  return backward;
}

}  // namespace touchtrace::label
