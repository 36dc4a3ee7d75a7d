#include "pipeline/scene/physics/contact_search.h"

#include <algorithm>
#include <limits>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Upper bounds: of a taxel's distance from the middle of the palm, and of its way a radian of
// flexion.
constexpr double hand_reach_m = 0.18, finger_reach_m = 0.20;

}  // namespace

/// A link, or the palm, in the object's axes.
struct TaxelSearch::Link {
  Matrix3d object_from_link;
  Vector3d origin_m;

  Link(const TaxelGroup& group, const HandFromObject& hand, const FingerPose* pose)
      : object_from_link(hand.object_from_hand), origin_m(hand.hand_m) {
    if (!pose) return;
    object_from_link = hand.object_from_hand * pose->hand_from_link[group.link];
    origin_m += hand.object_from_hand * pose->joint_m[group.link];
  }

  Lanes3 places_m(const Lanes3& positions_m) const {
    return product(object_from_link, positions_m) + Lanes3::all(origin_m);
  }
};

namespace {

/// Of a link, a radian of the flexion of its finger.
Twist with_flexion(const HandModel& model, const TaxelGroup& group, const HandFromObject& hand,
                   const FingerPose* pose) {
  Twist twist{Vector3d::Zero(), Vector3d::Zero()};
  if (!pose) return twist;
  const Finger& finger = model.fingers[group.finger];
  const Vector3d axis = hand.object_from_hand * pose->axis;
  for (int joint = 0; joint <= group.link; ++joint) {
    const Vector3d turn = finger.coupling[joint] * axis;
    twist.angular += turn;
    twist.linear -= turn.cross(hand.hand_m + hand.object_from_hand * pose->joint_m[joint]);
  }
  return twist;
}

}  // namespace

TaxelSearch::TaxelSearch(const HandModel& model)
    : model_(&model),
      due_(model.taxels.size()),
      taxel_free_until_m_(model.taxels.size(), 0.0),
      group_free_until_m_(model.groups.size(), 0.0),
      group_touched_(model.groups.size(), 0) {
  touches_.reserve(model.taxels.size());
}

const std::vector<TouchingBody>& TaxelSearch::find(const ObjectSpec& object,
                                                   const HandFromObject& hand, double margin_m) {
  margin_m_ = margin_m;
  touches_.clear();
  touching_.clear();
  clearance_m_ = 1.0;
  poses_.fill(std::nullopt);
  follow(hand);
  for (const TaxelGroup& group : model_->groups) search(group, object, hand);
  return touching_;
}

void TaxelSearch::follow(const HandFromObject& hand) {
  const double moved = (hand.hand_m - last_.hand_m).norm() +
                       hand_reach_m * (hand.object_from_hand - last_.object_from_hand).norm();
  travel_m_[0] += moved;
  for (int i = 0; i < finger_count; ++i)
    travel_m_[i + 1] +=
        moved + finger_reach_m * std::abs(hand.flexion_rad[i] - last_.flexion_rad[i]);
  last_ = hand;
}

const FingerPose& TaxelSearch::pose(int finger, const HandFromObject& hand) {
  if (!poses_[finger])
    poses_[finger] = pose_finger(model_->fingers[finger], hand.flexion_rad[finger]);
  return *poses_[finger];
}

/// Of a group that touched a single solid, the sphere would tell nothing.
void TaxelSearch::search(const TaxelGroup& group, const ObjectSpec& object,
                         const HandFromObject& hand) {
  const double travel = travel_m_[group.finger + 1];
  const auto index = static_cast<std::size_t>(&group - model_->groups.data());
  double& free_until = group_free_until_m_[index];
  if (travel + margin_m_ >= free_until) {
    const FingerPose* finger = group.finger < 0 ? nullptr : &pose(group.finger, hand);
    const Link link(group, hand, finger);
    if (!group_touched_[index] || object.solids.size() > 1)
      free_until = travel + approach_m(group, link, object);
    else
      solids_.assign(1, {&object.solids.front(), 0.0});
    const std::size_t before = touches_.size();
    const bool may_touch = travel + margin_m_ >= free_until;
    if (may_touch) look(group, link);
    const bool touches = touches_.size() > before;
    if (touches) note(group, with_flexion(*model_, group, hand, finger), before);
    if (group_touched_[index] && !touches) free_until = travel + approach_m(group, link, object);
    group_touched_[index] = touches;
  }
  clearance_m_ = std::clamp(free_until - travel, 0.0, clearance_m_);
}

/// How far its sphere is from the object; notes the solids that may be nearest to one of its
/// taxels.
double TaxelSearch::approach_m(const TaxelGroup& group, const Link& link,
                               const ObjectSpec& object) {
  const Lanes3 centre = link.places_m(Lanes3::all(group.centre_m));
  double nearest_m = std::numeric_limits<double>::infinity();
  solids_.clear();
  for (const Solid& solid : object.solids) {
    const double distance = distance_m(solid, centre)[0];
    solids_.push_back({&solid, distance});
    nearest_m = std::min(nearest_m, distance);
  }
  std::erase_if(solids_, [&](const NearbySolid& nearby) {
    return nearby.distance_m > nearest_m + 2 * group.radius_m;
  });
  return nearest_m - group.radius_m;
}

/// Looks at as many taxels at once as there are lanes.
void TaxelSearch::look(const TaxelGroup& group, const Link& link) {
  const double travel = travel_m_[group.finger + 1], reach = travel + margin_m_;
  int due = 0;
  for (int i = group.first; i < group.first + group.count; ++i) {
    due_[due] = i;
    due += reach >= taxel_free_until_m_[i];
  }
  for (int i = 0; i < due; i += lane_count)
    look(&due_[i], std::min(lane_count, due - i), travel, link);
}

void TaxelSearch::look(const int* taxels, int count, double travel, const Link& link) {
  Lanes3 positions;
#pragma GCC unroll 2
  for (int lane = 0; lane < lane_count; ++lane)
    positions.set(lane, model_->taxels[taxels[std::min(lane, count - 1)]].position_m);
  const Lanes3 places = link.places_m(positions);
  Lanes nearest_m = all_lanes(std::numeric_limits<double>::infinity());
  for (NearbySolid& nearby : solids_) {
    const Lanes distance = distance_m(*nearby.solid, places);
    nearby.is_nearest = distance < nearest_m;
    nearest_m = smallest(distance, nearest_m);
  }
  Lanes3 normals{};
  if (any(nearest_m < margin_m_))
    for (const NearbySolid& nearby : solids_)
      if (any(nearby.is_nearest))
        normals = choose(nearby.is_nearest, normal(*nearby.solid, places), normals);
  for (int lane = 0; lane < count; ++lane)
    if (nearest_m[lane] >= margin_m_)
      taxel_free_until_m_[taxels[lane]] = travel + nearest_m[lane];
    else
      touches_.push_back({taxels[lane], -nearest_m[lane], normals.at(lane), places.at(lane)});
}

/// The palm's groups are one body.
void TaxelSearch::note(const TaxelGroup& group, const Twist& with_flexion, std::size_t first) {
  if (group.finger >= 0 || touching_.empty())
    touching_.push_back({group.finger, with_flexion, first, 0});
  touching_.back().count = touches_.size() - touching_.back().first;
}

}  // namespace touchtrace::scene
