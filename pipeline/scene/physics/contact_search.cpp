#include "pipeline/scene/physics/contact_search.h"

#include <algorithm>
#include <limits>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Upper bounds of a taxel's distance from the palm's centre, and of its path per radian of flexion.
constexpr double hand_reach_m = 0.18, finger_reach_m = 0.20;

}  // namespace

/// Pose of a link in the object's body frame.
struct ContactSearch::LinkPose {
  Matrix3d object_from_link;
  Vector3d origin_m;

  LinkPose(const TaxelGroup& group, const HandInObject& hand, const FingerPose* pose)
      : object_from_link(hand.object_from_hand), origin_m(hand.origin_m) {
    if (!pose) return;
    object_from_link = hand.object_from_hand * pose->hand_from_link[group.link];
    origin_m += hand.object_from_hand * pose->joint_m[group.link];
  }

  Lanes3 points_m(const Lanes3& positions_m) const {
    return product(object_from_link, positions_m) + Lanes3::all(origin_m);
  }
};

namespace {

/// Twist of a link per rad/s of its finger's flexion.
Twist flexion_twist(const HandModel& model, const TaxelGroup& group, const HandInObject& hand,
                    const FingerPose* pose) {
  Twist twist{Vector3d::Zero(), Vector3d::Zero()};
  if (!pose) return twist;
  const Finger& finger = model.fingers[group.finger];
  const Vector3d axis = hand.object_from_hand * pose->axis;
  for (int joint = 0; joint <= group.link; ++joint) {
    const Vector3d turn = finger.coupling[joint] * axis;
    twist.angular += turn;
    twist.linear -= turn.cross(hand.origin_m + hand.object_from_hand * pose->joint_m[joint]);
  }
  return twist;
}

}  // namespace

ContactSearch::ContactSearch(const HandModel& model)
    : model_(&model),
      due_(model.taxels.size()),
      taxel_free_until_m_(model.taxels.size(), 0.0),
      group_free_until_m_(model.groups.size(), 0.0),
      group_touched_(model.groups.size(), 0) {
  contacts_.reserve(model.taxels.size());
}

const std::vector<LinkContacts>& ContactSearch::find(const ObjectSpec& object,
                                                     const HandInObject& hand, double margin_m) {
  margin_m_ = margin_m;
  contacts_.clear();
  links_.clear();
  clearance_m_ = 1.0;
  poses_.fill(std::nullopt);
  add_travel(hand);
  for (const TaxelGroup& group : model_->groups) search_group(group, object, hand);
  return links_;
}

void ContactSearch::add_travel(const HandInObject& hand) {
  const double moved = (hand.origin_m - last_.origin_m).norm() +
                       hand_reach_m * (hand.object_from_hand - last_.object_from_hand).norm();
  travel_m_[0] += moved;
  for (int i = 0; i < num_fingers; ++i)
    travel_m_[i + 1] +=
        moved + finger_reach_m * std::abs(hand.flexion_rad[i] - last_.flexion_rad[i]);
  last_ = hand;
}

const FingerPose& ContactSearch::pose(int finger, const HandInObject& hand) {
  if (!poses_[finger])
    poses_[finger] = pose_finger(model_->fingers[finger], hand.flexion_rad[finger]);
  return *poses_[finger];
}

/// The bounding sphere is skipped for a group that touched an object of one solid: it would
/// overlap.
void ContactSearch::search_group(const TaxelGroup& group, const ObjectSpec& object,
                                 const HandInObject& hand) {
  const double travel = travel_m_[group.finger + 1];
  const auto index = static_cast<std::size_t>(&group - model_->groups.data());
  double& free_until = group_free_until_m_[index];
  if (travel + margin_m_ >= free_until) {
    const FingerPose* finger = group.finger < 0 ? nullptr : &pose(group.finger, hand);
    const LinkPose link(group, hand, finger);
    if (!group_touched_[index] || object.solids.size() > 1)
      free_until = travel + group_distance_m(group, link, object);
    else
      solids_.assign(1, {&object.solids.front(), 0.0});
    const std::size_t before = contacts_.size();
    const bool may_touch = travel + margin_m_ >= free_until;
    if (may_touch) test_taxels(group, link);
    const bool touches = contacts_.size() > before;
    if (touches) append_link(group, flexion_twist(*model_, group, hand, finger), before);
    if (group_touched_[index] && !touches)
      free_until = travel + group_distance_m(group, link, object);
    group_touched_[index] = touches;
  }
  clearance_m_ = std::clamp(free_until - travel, 0.0, clearance_m_);
}

/// Distance of the group's sphere from the object. Collects the solids that may be nearest to one
/// of its taxels.
double ContactSearch::group_distance_m(const TaxelGroup& group, const LinkPose& link,
                                       const ObjectSpec& object) {
  const Lanes3 centre = link.points_m(Lanes3::all(group.centre_m));
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

void ContactSearch::test_taxels(const TaxelGroup& group, const LinkPose& link) {
  const double travel = travel_m_[group.finger + 1], reach = travel + margin_m_;
  int due = 0;
  for (int i = group.first; i < group.first + group.count; ++i) {
    due_[due] = i;
    due += reach >= taxel_free_until_m_[i];
  }
  for (int i = 0; i < due; i += num_lanes)
    test_taxels(&due_[i], std::min(num_lanes, due - i), travel, link);
}

/// Tests `count` taxels, at most one per lane.
void ContactSearch::test_taxels(const int* taxels, int count, double travel, const LinkPose& link) {
  Lanes3 positions;
#pragma GCC unroll 2
  for (int lane = 0; lane < num_lanes; ++lane)
    positions.set(lane, model_->taxels[taxels[std::min(lane, count - 1)]].position_m);
  const Lanes3 points = link.points_m(positions);
  Lanes nearest_m = broadcast(std::numeric_limits<double>::infinity());
  for (NearbySolid& nearby : solids_) {
    const Lanes distance = distance_m(*nearby.solid, points);
    nearby.is_nearest = distance < nearest_m;
    nearest_m = min(distance, nearest_m);
  }
  Lanes3 normals{};
  if (any(nearest_m < margin_m_))
    for (const NearbySolid& nearby : solids_)
      if (any(nearby.is_nearest))
        normals = select(nearby.is_nearest, normal(*nearby.solid, points), normals);
  for (int lane = 0; lane < count; ++lane)
    if (nearest_m[lane] >= margin_m_)
      taxel_free_until_m_[taxels[lane]] = travel + nearest_m[lane];
    else
      contacts_.push_back({taxels[lane], -nearest_m[lane], normals.at(lane), points.at(lane)});
}

/// The palm's groups are one link.
void ContactSearch::append_link(const TaxelGroup& group, const Twist& flexion_twist,
                                std::size_t first) {
  if (group.finger >= 0 || links_.empty())
    links_.push_back({group.finger, flexion_twist, first, 0});
  links_.back().count = contacts_.size() - links_.back().first;
}

}  // namespace touchtrace::scene
