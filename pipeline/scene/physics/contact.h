#pragma once

#include "pipeline/scene/base/parameters.h"
#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/physics/contact_search.h"
#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {

/// Motion of the hand relative to the object, in the object's body frame: the palm's twist, and
/// the fingers relative to the palm.
struct RelativeMotion {
  Twist palm;
  FingerRates flexion_rad_per_s;

  Twist link_twist(int finger, const Twist& flexion_twist) const {
    if (finger < 0) return palm;
    const double rate = flexion_rad_per_s[finger];
    return {palm.linear + rate * flexion_twist.linear, palm.angular + rate * flexion_twist.angular};
  }
};

/// Contact of the hand with the object: forces of all taxels and their friction states. Everything
/// is in the object's body frame. World::step() calls find(), then add_to() and release_tensile()
/// until no contact pulls, then finish_step(). Within a step of h, contact geometry is evaluated at
/// the explicit time (1 - theta) h; forces are linear in the mean velocities over the step, which
/// act over the implicit time theta h.
class ContactPatch {
 public:
  explicit ContactPatch(const ContactParameters& parameters = {},
                        const HandModel& model = hand_model());

  /// Finds the taxels that touch after `explicit_s`, or may touch `implicit_s` later, and
  /// linearizes their forces. `hand` is the pose after `explicit_s`, `motion` the present motion.
  /// The Coulomb limit is taken at `expected`, a prediction of the step's mean motion, which makes
  /// sliding second order in the step.
  void find(const ObjectSpec& object, const HandInObject& hand, const RelativeMotion& motion,
            const RelativeMotion& expected, double explicit_s, double implicit_s);
  /// Adds the forces times the implicit time to the system. `imposed` is the hand's motion that is
  /// not solved for.
  void add_to(MotionSystem& system, const Twist& imposed) const;
  /// Removes the contacts that would pull at the solution `motion`. Returns true if there are any;
  /// then the system has to be solved again.
  bool release_tensile(const RelativeMotion& motion);
  /// Computes forces, sums and new friction states for the solution `motion` of a step of `h`.
  void finish_step(const RelativeMotion& motion, double h);

  const ContactParameters& parameters() const { return parameters_; }
  bool touching() const { return num_touching_ > 0; }
  double clearance_m() const { return search_.clearance_m(); }
  std::span<const double> force_n() const { return force_n_; }  ///< normal force of every taxel
  std::span<const int> loaded() const { return loaded_; }       ///< taxels in contact
  /// Force and torque of the hand on the object, about its centre of mass.
  const Eigen::Vector3d& force_on_object_n() const { return force_on_object_n_; }
  const Eigen::Vector3d& torque_on_object_nm() const { return torque_on_object_nm_; }
  double normal_force_n(int finger) const { return finger_force_n_[finger + 1]; }  ///< -1: palm
  /// Torque about the finger's first joint over its normal force; 0 without force.
  double lever_m(int finger) const;
  /// Number of contacts deeper than max_depth_m so far, summed over steps.
  long num_clamped() const { return num_clamped_; }
  /// Largest speed of a contact relative to the object in the last step.
  double max_speed_m_per_s() const { return max_speed_m_per_s_; }

 private:
  /// One contact per lane, all of one link. Force on a taxel:
  /// (normal_n - normal_gain n.v) n + tangent_n - tangent_gain (v - n n.v).
  struct ContactLanes {
    int taxel[num_lanes];
    LaneMask is_active;  ///< no force where unset
    Lanes3 point_m, normal;
    Lanes depth_m, stiffness_n_per_m, normal_n, normal_gain;
    Lanes3 bristle_m, tangent_n;
    Lanes tangent_k, tangent_gain;

    /// Surplus lanes repeat the first contact and are inactive.
    ContactLanes(const HandModel& model, std::span<const TaxelContact> contacts,
                 double stiffness_n_per_m3);
    Lanes normal_force_n(const Lanes3& v) const { return normal_n - normal_gain * dot(normal, v); }
    void release(int lane);
  };
  /// A link and the range of its contacts.
  struct Link {
    int finger;
    Twist flexion_twist;
    std::size_t first, count;
  };

  std::span<ContactLanes> contacts_of(const Link& link) {
    return std::span(contacts_).subspan(link.first, link.count);
  }
  std::span<const ContactLanes> contacts_of(const Link& link) const {
    return std::span(contacts_).subspan(link.first, link.count);
  }
  void add_link(const LinkContacts& link, const Twist& motion, const Twist& expected);
  void set_normal_force(ContactLanes& contacts, const Lanes3& velocity,
                        const Lanes3& expected) const;
  void set_friction(ContactLanes& contacts, Lanes damping_s, const Lanes3& expected) const;
  Lanes3 initial_bristles_m(const ContactLanes& contacts, const Lanes3& velocity, Lanes rate) const;
  void finish_link(const Link& link, const Twist& twist, double h);
  void store(const ContactLanes& contacts, Lanes pressed_n, const Lanes3& creep, double h);

  ContactParameters parameters_;
  const HandModel* model_;
  ContactSearch search_;
  std::vector<Link> links_;
  std::vector<ContactLanes> contacts_;  ///< link by link
  std::vector<double> force_n_;
  std::vector<Eigen::Vector3d> bristle_m_;  ///< tangential deflection of each taxel
  std::vector<long> touched_at_;            ///< last step in which the taxel touched
  std::vector<int> loaded_;                 ///< taxels whose force is to be cleared
  std::array<double, num_fingers + 1> finger_force_n_{}, finger_torque_nm_{};
  Eigen::Vector3d force_on_object_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_on_object_nm_ = Eigen::Vector3d::Zero();
  double friction_ = 0.0, explicit_s_ = 0.0, implicit_s_ = 0.0, max_speed_m_per_s_ = 0.0;
  long step_ = 0, num_clamped_ = 0;
  int num_touching_ = 0;
};

}  // namespace touchtrace::scene
