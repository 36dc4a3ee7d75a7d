#include "pipeline/label/follow.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/interrupt.h"
#include "engine/base/statistics.h"
#include "pipeline/label/box_tracker.h"
#include "pipeline/label/lift.h"
#include "pipeline/label/pose_tracker.h"
#include "pipeline/label/sphere_fit.h"
#include "pipeline/label/target_filter.h"

namespace touchtrace::label {
namespace {

constexpr double hand_disc_m = 0.05, hand_sigma_m = 0.004;
// Of an object's place in a hand that hides it, as the hand has it now and as the first box says;
// and how that place shakes from frame to frame.
constexpr double in_hand_sigma_m = 0.02, unseen_sigma_m = 0.03, hidden_sigma_m = 0.005;
constexpr double hidden = 0.5;  // part of the rays to an object that something hides
constexpr std::size_t grip_frames = 15;
constexpr double reach_m =
    0.07;  // an object so much farther from the hand than in the grip is away
constexpr double longest_flight_s = 1.0;  // what is not seen for longer has been caught
constexpr double reaches = 2.0;           // from a visible end of an object to its other end
constexpr std::size_t fewest_hand = 30, fewest_object = 6;

// Where the colours of two bodies mix points err more, and the less is seen of a body the more of
// it is edge.
constexpr double edge_part = 0.25;
constexpr double least_sigma_m = 0.0003, most_sigma_m = 0.03;

/// Deviations of a body's centre along the axes, of which the part `visible` is seen.
Eigen::Vector3d deviations(const Eigen::Matrix3d& information, double visible, double of_point_m) {
  const double point_m2 = of_point_m * of_point_m * (1.0 + edge_part / visible);
  const Eigen::Matrix3d least =
      Eigen::Matrix3d::Identity() * point_m2 / (most_sigma_m * most_sigma_m);
  const Eigen::Vector3d variance = (information + least).inverse().diagonal();
  return (variance.array() * point_m2 + least_sigma_m * least_sigma_m).sqrt();
}

Observation observe_hand(const Patch& patch) {
  return {
      true, false, patch.centroid_m, {hand_sigma_m, hand_sigma_m, 1.5 * hand_sigma_m}, patch.box};
}

Observation in_hand_at(const Eigen::Vector3d& position_m) {
  Observation object;
  object.found = object.follows_hand = true;
  object.position_m = position_m;
  object.sigma_m.setConstant(hidden_sigma_m);
  return object;
}

/// Where the hand has the object: the median of the last frames that showed it, so that the few in
/// which it is leaving do not count.
class Grip {
 public:
  /// Distance of object and hand when both were first seen.
  double first_m() const { return first_m_; }

  void take_in(const Eigen::Vector3d& object_from_hand_m) {
    if (last_.empty()) first_m_ = object_from_hand_m.norm();
    last_.push_back(object_from_hand_m);
    if (last_.size() > grip_frames) last_.erase(last_.begin());
  }

  Eigen::Vector3d object_from_hand_m() const {
    Eigen::Vector3d result;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const auto& offset : last_) values.push_back(offset[axis]);
      result[axis] = median(std::move(values));
    }
    return result;
  }

 private:
  std::vector<Eigen::Vector3d> last_;
  double first_m_ = 0.0;
};

/// Hand and object of one clip.
class Follower {
 public:
  Follower(const SceneModel& scene, FramesAhead::Reader& frames, const ClipFrames& clip,
           const Eigen::Vector3d& gravity, const TrackerKind& kind)
      : scene_(scene),
        frames_(frames),
        clip_(clip),
        gravity_(gravity),
        shape_(scene.object_shape.at(clip.object)),
        hand_(Body::hand, hand_disc_m, hand_patch_radius_m, fewest_hand, kind),
        object_(Body::object, shape_.radius_m, object_patch_radii * shape_.radius_m, fewest_object,
                kind) {
    if (shape_.body) pose_.emplace(*shape_.body);
  }

  void step(SeenFrame seen, double seconds, ClipTrack& track) {
    auto& [frame, surface, image] = seen;
    if (started_ && scene_.like_the_hand.contains(clip_.object))
      scene_.split(surface, clip_.object, hand_.expected_m());
    std::optional<Patch> hand, object;
    if (!started_) {
      hand = hand_.begin(surface, clip_.hand_box);
      object = object_.begin(surface, clip_.object_box);
    } else {
      hand_.predict(seconds, false, gravity_);
      object_.predict(seconds, away_, gravity_);
      const auto [hand_box, object_box] = tracked(image);
      hand = hand_.find(surface, image, hand_box, scene_.segmenter, std::nullopt);
      if (hand && hand_.is_lost() && object_.is_lost()) look_in_hand(*hand);
      object = object_.find(surface, image, object_box, scene_.segmenter, in_hand(hand));
    }
    frame_ = track.hand.size();
    track.hand.push_back(hand ? observe_hand(*hand) : Observation{});
    unseen_s_ += seconds;
    track.object.push_back(object ? observe_object(*object, frame) : Observation{});
    take_in(track.hand.back(), track.object.back(), frame, image);
  }

  /// Poses become what all frames together say of them.
  void settle(ClipTrack& track) const {
    if (!pose_) return;
    const auto fits = pose_->likeliest();
    for (std::size_t i = 0; i < fits.size(); ++i)
      place(track.object[posed_[i].frame], fits[i], posed_[i].points);
  }

  int restarts() const { return hand_.restarts() + object_.restarts(); }

 private:
  /// The trackers' boxes on hand and object.
  std::array<std::optional<PixelBox>, 2> tracked(const MaskedImage& image) {
    const auto& camera = scene_.segmenter.color_camera();
    std::array<std::optional<PixelBox>, 2> boxes;
    frames_.both([&] { boxes[0] = hand_.track(image, camera); },
                 [&] { boxes[1] = object_.track(image, camera); });
    return boxes;
  }

  Observation observe_object(const Patch& patch, const RgbdFrame& frame) {
    const auto view =
        scene_.view_body(frame, clip_.object, patch, reaches * shape_.reach_m(), pose_.has_value());
    const double unseen_s = std::exchange(unseen_s_, 0.0);
    Observation object{true, false, {}, {}, patch.box};
    if (pose_) {
      posed_.push_back({frame_, view.on_m.size()});
      place(object, pose_->see(view, unseen_s), view.on_m.size());
    } else {
      const auto fit = fit_sphere(view, shape_.radius_m);
      place(object, fit.center_m, fit.information, view.on_m.size());
    }
    return object;
  }

  void place(Observation& object, const BodyFit& fit, std::size_t points) const {
    place(object, fit.center_m(), fit.center_information(), points);
  }

  /// Where it is, and how well that is known by so many points.
  void place(Observation& object, const Eigen::Vector3d& center_m,
             const Eigen::Matrix3d& information, std::size_t points) const {
    const double visible =
        static_cast<double>(points) / scene_.segmenter.disc_pixels(shape_.radius_m, center_m.z());
    object.position_m = center_m;
    object.sigma_m = deviations(information, visible, pose_ ? point_sigma_m : sphere_point_sigma_m);
  }

  /// Where the object would be in the hand; nothing of one that has left it and is not back yet.
  std::optional<Eigen::Vector3d> in_hand(const std::optional<Patch>& hand) const {
    if (!hand || away_) return std::nullopt;
    return hand->centroid_m + grip_.object_from_hand_m();
  }

  /// Nobody saw where the object went.
  void look_in_hand(const Patch& hand) {
    away_ = false;
    object_.hide(hand.centroid_m + grip_.object_from_hand_m(), unseen_sigma_m);
  }

  /// Both filters get what was seen; an object hidden in the hand goes where the hand goes.
  void take_in(const Observation& hand, Observation& object, const RgbdFrame& frame,
               const MaskedImage& image) {
    if (!started_) {
      begin(hand, object, image);
      return;
    }
    if (hand.found) hand_.measure(hand.position_m, hand_sigma_m);
    if (!object.found && hand.found) {
      away_ = away_ && !is_back(hand);
      if (!away_) follow_hand(hand, frame, object);
    }
    if (object.follows_hand)
      object_.hide(object.position_m, in_hand_sigma_m);
    else if (object.found)
      object_.measure(object.position_m, object.sigma_m.maxCoeff());
    if (hand.found && object.found && !object.follows_hand) {
      const Eigen::Vector3d apart = object.position_m - hand.position_m;
      away_ = apart.norm() > grip_.first_m() + reach_m;
      if (!away_) grip_.take_in(apart);
    }
  }

  /// Whether an object that was away must have come back into the hand.
  bool is_back(const Observation& hand) const {
    return unseen_s_ > longest_flight_s ||
           (object_.expected_m() - hand.position_m).norm() < grip_.first_m() + reach_m;
  }

  /// An object that is not seen is in the hand, if something hides it there and it was not about to
  /// leave the picture.
  void follow_hand(const Observation& hand, const RgbdFrame& frame, Observation& object) {
    if (!scene_.segmenter.in_picture(object_.expected_m())) return;
    for (const double part : {1.0, 0.67, 0.33, 0.0}) {  // the nearest place that would hide it
      const Eigen::Vector3d place = hand.position_m + part * grip_.object_from_hand_m();
      if (scene_.hidden_part(frame, place, shape_.radius_m) < hidden) continue;
      object = in_hand_at(place);
      return;
    }
  }

  /// An object that does not show in its box is hidden in the hand, behind what shows of that,
  /// where its box is.
  void begin(const Observation& hand, Observation& object, const MaskedImage& image) {
    if (!hand.found) return;
    hand_.start(hand.position_m, hand_sigma_m, hand.box, image);
    if (object.found)
      object_.start(object.position_m, object.sigma_m.maxCoeff(), object.box, image);
    else
      start_in_box(hand, object);
    grip_.take_in(object.position_m - hand.position_m);
    started_ = true;
  }

  void start_in_box(const Observation& hand, Observation& object) {
    const auto& box = clip_.object_box;
    const Eigen::Vector3d ray = scene_.segmenter.color_camera().unproject(
        {box.x + 0.5 * box.width, box.y + 0.5 * box.height});
    object = in_hand_at((hand.position_m.z() + shape_.radius_m) * ray);
    object_.start(object.position_m, unseen_sigma_m, {}, {});
    object_.hide(object.position_m, unseen_sigma_m);
  }

  const SceneModel& scene_;
  FramesAhead::Reader& frames_;
  const ClipFrames& clip_;
  Eigen::Vector3d gravity_;
  Grip grip_;
  const ObjectShape& shape_;
  /// A frame with a pose, and the points that showed it.
  struct Posed {
    std::size_t frame, points;
  };
  std::optional<PoseTracker> pose_;  ///< of an object that is no sphere
  std::vector<Posed> posed_;
  std::size_t frame_ = 0;
  double unseen_s_ = 0.0;  ///< since the object was seen
  Target hand_, object_;
  bool started_ = false, away_ = false;
};

}  // namespace

ClipTrack follow(const SceneModel& scene, FramesAhead::Reader& frames, const ClipFrames& clip,
                 const std::vector<double>& frame_time_s, const Eigen::Vector3d& gravity_m_per_s2,
                 const TrackerKind& tracker) {
  Follower follower(scene, frames, clip, gravity_m_per_s2, tracker);
  ClipTrack track;
  for (std::size_t i = clip.first; i < clip.first + clip.count; ++i) {
    throw_if_interrupted();
    const double seconds = i > clip.first ? frame_time_s[i] - frame_time_s[i - 1] : 0.0;
    follower.step(frames.next(), seconds, track);
    track.time_s.push_back(frame_time_s[i]);
  }
  follower.settle(track);
  track.object_middle_sigma_m = scene.object_shape.at(clip.object).middle_sigma_m;
  track.restarts = follower.restarts();
  return track;
}

}  // namespace touchtrace::label
