#pragma once

#include <optional>

#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// The hand as the object sees it: everything in the object's axes, from its centre of mass.
struct HandFromObject {
  Eigen::Matrix3d object_from_hand = Eigen::Matrix3d::Identity();
  Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();
  std::array<double, finger_count> flexion_rad{};
};

/// A taxel inside the object or near it, in the object's axes.
struct Touch {
  int taxel, finger;             ///< finger -1: the palm
  double depth_m;                ///< negative: not in contact yet
  Eigen::Vector3d normal;        ///< out of the object
  Eigen::Vector3d place_m;       ///< from its centre of mass
  Eigen::Vector3d with_flexion;  ///< how the place moves with the finger's flexion [m/rad]
};

/// Finds what touches. Distances change no faster than their points move, so a taxel or group that
/// was clear by d is not looked at until it may have moved by d against the object.
class TaxelSearch {
 public:
  explicit TaxelSearch(const HandModel& model);

  /// Taxels inside the object or less than `margin_m` outside.
  const std::vector<Touch>& find(const ObjectSpec& object, const HandFromObject& hand,
                                 double margin_m);
  /// How far hand and object can move against each other before anything may touch [m]; 0 in
  /// contact.
  double clearance_m() const { return clearance_m_; }

 private:
  struct Link;

  void follow(const HandFromObject& hand);
  const FingerPose& pose(int finger, const HandFromObject& hand);
  void search(const TaxelGroup& group, const ObjectSpec& object, const HandFromObject& hand);
  void look(const TaxelGroup& group, const Link& link, const ObjectSpec& object);

  const HandModel* model_;
  std::vector<Touch> touches_;
  std::array<std::optional<FingerPose>, finger_count> poses_;  ///< those needed so far
  /// Travels at which a taxel or group may touch at the soonest.
  std::vector<double> taxel_free_until_m_, group_free_until_m_;
  std::array<double, finger_count + 1> travel_m_{};  ///< against the object, of palm and fingers
  HandFromObject last_;
  double clearance_m_ = 0.0, margin_m_ = 0.0;
};

}  // namespace touchtrace::scene
