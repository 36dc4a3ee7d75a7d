#include "pipeline/scene/physics/contact_search.h"

#include <algorithm>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Upper bounds: of a taxel's distance from the middle of the palm, and of its way a radian of
// flexion.
constexpr double hand_reach_m = 0.18, finger_reach_m = 0.20;

}  // namespace

/// A link in the object's axes. A place p on it moves by axis x (coupled p - pivot) with the
/// flexion.
struct TaxelSearch::Link {
  int finger = -1;
  Matrix3d object_from_link;
  Vector3d origin_m;
  double coupled = 0.0;
  Vector3d axis = Vector3d::Zero(), pivot_m = Vector3d::Zero();

  Link(const HandModel& model, const TaxelGroup& group, const HandFromObject& hand,
       const FingerPose* pose)
      : finger(group.finger), object_from_link(hand.object_from_hand), origin_m(hand.hand_m) {
    if (!pose) return;
    const Finger& f = model.fingers[finger];
    axis = hand.object_from_hand * pose->axis;
    for (int joint = 0; joint <= group.link; ++joint) {
      coupled += f.coupling[joint];
      pivot_m += f.coupling[joint] * (hand.hand_m + hand.object_from_hand * pose->joint_m[joint]);
    }
    object_from_link = hand.object_from_hand * pose->hand_from_link[group.link];
    origin_m += hand.object_from_hand * pose->joint_m[group.link];
  }

  Vector3d place(const Vector3d& position_m) const {
    return object_from_link * position_m + origin_m;
  }
  Vector3d with_flexion(const Vector3d& place_m) const {
    return axis.cross(coupled * place_m - pivot_m);
  }
};

TaxelSearch::TaxelSearch(const HandModel& model)
    : model_(&model),
      taxel_free_until_m_(model.taxels.size(), 0.0),
      group_free_until_m_(model.groups.size(), 0.0) {
  touches_.reserve(model.taxels.size());
}

const std::vector<Touch>& TaxelSearch::find(const ObjectSpec& object, const HandFromObject& hand,
                                            double margin_m) {
  margin_m_ = margin_m;
  touches_.clear();
  clearance_m_ = 1.0;
  poses_.fill(std::nullopt);
  follow(hand);
  for (const TaxelGroup& group : model_->groups) search(group, object, hand);
  return touches_;
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

void TaxelSearch::search(const TaxelGroup& group, const ObjectSpec& object,
                         const HandFromObject& hand) {
  const double travel = travel_m_[group.finger + 1];
  double& free_until = group_free_until_m_[&group - model_->groups.data()];
  if (travel + margin_m_ >= free_until) {
    const Link link(*model_, group, hand, group.finger < 0 ? nullptr : &pose(group.finger, hand));
    const double distance = distance_m(object, link.place(group.centre_m));
    free_until = travel + distance - group.radius_m;
    if (travel + margin_m_ >= free_until) look(group, link, object);
  }
  clearance_m_ = std::clamp(free_until - travel, 0.0, clearance_m_);
}

void TaxelSearch::look(const TaxelGroup& group, const Link& link, const ObjectSpec& object) {
  const double travel = travel_m_[group.finger + 1];
  for (int i = group.first; i < group.first + group.count; ++i) {
    if (travel + margin_m_ < taxel_free_until_m_[i]) continue;
    const Vector3d place = link.place(model_->taxels[i].position_m);
    const NearestSolid nearest = nearest_solid(object, place);
    if (nearest.distance_m >= margin_m_)
      taxel_free_until_m_[i] = travel + nearest.distance_m;
    else
      touches_.push_back({i, group.finger, -nearest.distance_m, nearest.normal(), place,
                          link.with_flexion(place)});
  }
}

}  // namespace touchtrace::scene
