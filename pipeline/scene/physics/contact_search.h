#pragma once

#include <optional>
#include <span>

#include "pipeline/scene/objects/solids.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// The hand as the object sees it: everything in the object's axes, from its centre of mass.
struct HandFromObject {
  Eigen::Matrix3d object_from_hand = Eigen::Matrix3d::Identity();
  Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();
  std::array<double, finger_count> flexion_rad{};
};

/// How a rigid body moves: its place p by linear + angular x p.
struct Twist {
  Eigen::Vector3d linear, angular;

  Eigen::Vector3d at(const Eigen::Vector3d& place_m) const {
    return linear + angular.cross(place_m);
  }
};

/// A taxel inside the object or near it, in the object's axes.
struct Touch {
  int taxel;
  double depth_m;           ///< negative: not in contact yet
  Eigen::Vector3d normal;   ///< out of the object
  Eigen::Vector3d place_m;  ///< from its centre of mass
};

/// What touches of the palm or of one link, which are rigid.
struct TouchingBody {
  int finger;                ///< -1: the palm
  Twist with_flexion;        ///< a radian of the finger's flexion; 0 for the palm
  std::size_t first, count;  ///< of its touches
};

/// Finds what touches. Distances change no faster than their points move, so a taxel or group that
/// was clear by d is not looked at until it may have moved by d against the object.
class TaxelSearch {
 public:
  explicit TaxelSearch(const HandModel& model);

  /// Taxels inside the object or less than `margin_m` outside.
  const std::vector<TouchingBody>& find(const ObjectSpec& object, const HandFromObject& hand,
                                        double margin_m);
  /// Until the next search.
  std::span<const Touch> touches(const TouchingBody& body) const {
    return std::span(touches_).subspan(body.first, body.count);
  }
  /// How far hand and object can move against each other before anything may touch [m]; 0 in
  /// contact.
  double clearance_m() const { return clearance_m_; }

 private:
  struct Link;
  struct NearbySolid {
    const Solid* solid;
    double distance_m;      ///< of the group's centre
    LaneMask is_nearest{};  ///< of the solids so far, to the taxels that are looked at
  };

  void follow(const HandFromObject& hand);
  const FingerPose& pose(int finger, const HandFromObject& hand);
  void search(const TaxelGroup& group, const ObjectSpec& object, const HandFromObject& hand);
  double approach_m(const TaxelGroup& group, const Link& link, const ObjectSpec& object);
  void look(const TaxelGroup& group, const Link& link);
  void look(const int* taxels, int count, double travel, const Link& link);
  void note(const TaxelGroup& group, const Twist& with_flexion, std::size_t first);

  const HandModel* model_;
  std::vector<Touch> touches_;
  std::vector<TouchingBody> touching_;
  std::vector<NearbySolid> solids_;  ///< those that may be nearest to a taxel of the group
  std::vector<int> due_;             ///< taxels of the group that may touch
  std::array<std::optional<FingerPose>, finger_count> poses_;  ///< those needed so far
  /// Travels at which a taxel or group may touch at the soonest.
  std::vector<double> taxel_free_until_m_, group_free_until_m_;
  std::vector<std::uint8_t> group_touched_;          ///< when last looked at
  std::array<double, finger_count + 1> travel_m_{};  ///< against the object, of palm and fingers
  HandFromObject last_;
  double clearance_m_ = 0.0, margin_m_ = 0.0;
};

}  // namespace touchtrace::scene
