#pragma once

#include <optional>
#include <span>

#include "pipeline/scene/objects/solids.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// Pose of the hand in the object's body frame.
struct HandInObject {
  Eigen::Matrix3d object_from_hand = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::array<double, num_fingers> flexion_rad{};
};

/// Velocity field of a rigid body: linear + angular x point.
struct Twist {
  Eigen::Vector3d linear, angular;

  Eigen::Vector3d at(const Eigen::Vector3d& point_m) const {
    return linear + angular.cross(point_m);
  }
};

/// A taxel in or near the object, in the object's body frame.
struct TaxelContact {
  int taxel;
  double depth_m;           ///< negative: not in contact yet
  Eigen::Vector3d normal;   ///< outward normal of the object
  Eigen::Vector3d point_m;  ///< position of the taxel
};

/// Contacts of one rigid link of the hand: the palm or a link of a finger.
struct LinkContacts {
  int finger;                ///< -1: the palm
  Twist flexion_twist;       ///< twist of the link per rad/s of the finger's flexion; 0: the palm
  std::size_t first, count;  ///< range of the link's contacts
};

/// Broad and narrow phase of the collision of hand and object. A distance changes no faster than
/// the point moves, so a taxel or group at distance d is tested again only after it may have moved
/// by d relative to the object.
class ContactSearch {
 public:
  explicit ContactSearch(const HandModel& model);

  /// Finds the taxels inside the object or less than `margin_m` outside. Valid until the next call.
  const std::vector<LinkContacts>& find(const ObjectSpec& object, const HandInObject& hand,
                                        double margin_m);
  std::span<const TaxelContact> contacts(const LinkContacts& link) const {
    return std::span(contacts_).subspan(link.first, link.count);
  }
  /// Lower bound of the relative motion before any taxel touches [m]; 0 in contact.
  double clearance_m() const { return clearance_m_; }

 private:
  struct LinkPose;
  struct NearbySolid {
    const Solid* solid;
    double distance_m;      ///< of the group's centre
    LaneMask is_nearest{};  ///< per tested taxel, among the solids so far
  };

  void add_travel(const HandInObject& hand);
  const FingerPose& pose(int finger, const HandInObject& hand);
  void search_group(const TaxelGroup& group, const ObjectSpec& object, const HandInObject& hand);
  double group_distance_m(const TaxelGroup& group, const LinkPose& link, const ObjectSpec& object);
  void test_taxels(const TaxelGroup& group, const LinkPose& link);
  void test_taxels(const int* taxels, int count, double travel, const LinkPose& link);
  void append_link(const TaxelGroup& group, const Twist& flexion_twist, std::size_t first);

  const HandModel* model_;
  std::vector<TaxelContact> contacts_;
  std::vector<LinkContacts> links_;
  std::vector<NearbySolid> solids_;  ///< that may be nearest to a taxel of the group
  std::vector<int> due_;             ///< taxels of the group that may touch
  std::array<std::optional<FingerPose>, num_fingers> poses_;  ///< computed on demand
  /// Travel until which a taxel or group cannot touch.
  std::vector<double> taxel_free_until_m_, group_free_until_m_;
  std::vector<std::uint8_t> group_touched_;         ///< at its last test
  std::array<double, num_fingers + 1> travel_m_{};  ///< relative to the object, of palm and fingers
  HandInObject last_;
  double clearance_m_ = 0.0, margin_m_ = 0.0;
};

}  // namespace touchtrace::scene
