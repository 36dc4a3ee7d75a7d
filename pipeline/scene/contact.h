#pragma once

#include "pipeline/scene/hand.h"

namespace touchtrace::scene {

/// Order of the velocities that are solved for together.
inline constexpr int hand_at = 0, object_at = 3, spin_at = 6, fingers_at = 9;
inline constexpr int velocity_count = fingers_at + finger_count;

using ContactSystem = Eigen::Matrix<double, velocity_count, velocity_count>;
using ContactVelocity = Eigen::Matrix<double, velocity_count, 1>;

/// Winkler foundation under every taxel, as soft tissue and glove: f = k d (1 + d / d0) (1 + c d'),
/// friction a bristle of 0.7 k with the same relative damping, clipped at the Coulomb limit.
struct ContactParameters {
  double stiffness_n_per_m3 = 1e7, hardening_m = 0.003, dissipation_s_per_m = 3.0;
  double bristle_ratio = 0.7;
  double clamp_m = 0.008;  ///< deeper than this the law is not meant; counted
};

/// Where things are when contacts are looked for.
struct ContactScene {
  const ObjectSpec& spec;
  const RigidState& hand;
  const RigidState& object;
  Eigen::Vector3d hand_spin;  ///< imposed angular velocity
  const std::array<double, finger_count>& flexion_rad;
  const ContactVelocity& velocity;  ///< of everything, at present
};

/// All taxels that touch the object, and the tangential state of each.
class ContactPatch {
 public:
  explicit ContactPatch(const ContactParameters& parameters = {});

  /// Finds what touches; later calls are about this instant. `h` is the step to be made.
  void find(const ContactScene& scene, double h);
  /// Adds h (stiffness h + damping) to `system` and the contacts' impulse to `momentum`.
  /// Only the lower triangle of `system` is written.
  void add_to(ContactSystem& system, ContactVelocity& momentum, double h) const;
  /// Lets go of contacts that would have to pull at the velocities solved for; true if there were
  /// any, and the system has to be solved again without them.
  bool part(const ContactVelocity& next, const Eigen::Vector3d& hand_spin);
  /// With the velocities solved for: forces of every taxel, friction states, sums.
  void settle(const ContactVelocity& next, const Eigen::Vector3d& hand_spin, double h);

  bool touching() const { return !contacts_.empty(); }
  /// Distance of the nearest group's bounding sphere from the object [m] when find() ran; 0 in
  /// contact.
  double clearance_m() const { return clearance_m_; }
  std::span<const double> force_n() const { return force_n_; }  ///< normal, of every taxel
  const Eigen::Vector3d& force_on_object_n() const { return force_on_object_n_; }
  const Eigen::Vector3d& torque_on_object_nm() const { return torque_on_object_nm_; }
  double normal_force_n(int finger) const { return finger_force_n_[finger + 1]; }  ///< -1: palm
  double lever_m(
      int finger) const;  ///< torque about the first joint a newton of the finger's force
  long clamp_hits() const { return clamp_hits_; }

 private:
  struct Contact {
    int taxel, finger;
    Eigen::Vector3d normal;                                ///< out of the object, world
    Eigen::Vector3d from_object, from_hand, with_flexion;  ///< lever arms and dp/dflexion, world
    double elastic_n, rate_gain;  ///< normal force at rest, and its growth with d' (h k + c)
    double tangent_share, tangent_k, tangent_c;
    Eigen::Matrix3d resistance;  ///< force against relative velocity, implicit part
    Eigen::Vector3d push;        ///< force on the taxel at zero relative velocity
  };
  struct Frame;

  void search(const TaxelGroup& group, const Frame& frame, const ContactScene& scene, double h);
  void follow(const Eigen::Matrix3d& object_from_hand, const Eigen::Vector3d& hand_in_object,
              const std::array<double, finger_count>& flexion_rad);
  void touch(int taxel, const TaxelGroup& group, const Eigen::Vector3d& point, const Frame& frame,
             const ContactScene& scene, double h);
  void load(Contact& contact, double depth, const ContactScene& scene, double h);
  void rub(Contact& contact, double stiffness, double damping_s, const Eigen::Vector3d& creep,
           double normal_force, double h);
  static Eigen::Vector3d slide(const Contact& contact, const ContactVelocity& velocity,
                               const Eigen::Vector3d& hand_spin);
  void apply(const Contact& contact, const Eigen::Vector3d& velocity, double h);

  ContactParameters parameters_;
  std::vector<Contact> contacts_;
  std::vector<double> force_n_;
  std::vector<Eigen::Vector3d> bristle_m_;  ///< tangential stretch, world
  std::vector<long> touched_at_;            ///< step in which the taxel last touched
  /// Travels at which a taxel or group may touch at the soonest.
  std::vector<double> taxel_free_until_m_, group_free_until_m_;
  std::array<double, finger_count + 1> travel_m_{};  ///< against the object, of palm and fingers
  Eigen::Matrix3d last_object_from_hand_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d last_hand_in_object_ = Eigen::Vector3d::Zero();
  std::array<double, finger_count> last_flexion_rad_{};
  std::vector<int> loaded_;  ///< taxels with a force, to be cleared
  std::array<double, finger_count + 1> finger_force_n_{}, finger_torque_nm_{};
  Eigen::Vector3d force_on_object_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_on_object_nm_ = Eigen::Vector3d::Zero();
  double clearance_m_ = 0.0, friction_ = 0.0;
  long step_ = 0, clamp_hits_ = 0;
};

}  // namespace touchtrace::scene
