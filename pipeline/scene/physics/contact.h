#pragma once

#include "pipeline/scene/base/parameters.h"
#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/physics/contact_search.h"
#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {

/// How the hand moves against the object, in the object's axes: its palm [m/s, rad/s], and its
/// fingers against the palm.
struct RelativeMotion {
  Twist palm;
  FingerRates flexion_rad_per_s;

  Twist of(int finger, const Twist& with_flexion) const {
    if (finger < 0) return palm;
    const double rate = flexion_rad_per_s[finger];
    return {palm.linear + rate * with_flexion.linear, palm.angular + rate * with_flexion.angular};
  }
};

/// All taxels that touch the object, and the tangential state of each. Everything is in the
/// object's axes. Forces are linear in the velocities that are solved for, the means over a step.
class ContactPatch {
 public:
  explicit ContactPatch(const ContactParameters& parameters = {},
                        const HandModel& model = hand_model());

  /// Finds what touches where things have got to, `looked_s` from now, with the present `motion`,
  /// or may touch `ahead_s` from now, which later calls are about. Coulomb's limit is taken at the
  /// motion `expected` of the step, which makes sliding second order in it.
  void find(const ObjectSpec& object, const HandFromObject& hand, const RelativeMotion& motion,
            const RelativeMotion& expected, double looked_s, double ahead_s);
  /// Adds the time ahead times the contacts' forces: what grows with the velocities to the system's
  /// left side, the rest to its right. `imposed` is the hand's motion that is not solved for.
  void add_to(MotionSystem& system, const Twist& imposed) const;
  /// Lets go of contacts that would have to pull at the velocities solved for; true if there were
  /// any, and the system has to be solved again without them.
  bool part(const RelativeMotion& motion);
  /// With the velocities solved for, and a step of `h`: forces of every taxel, friction states,
  /// sums.
  void settle(const RelativeMotion& motion, double h);

  const ContactParameters& parameters() const { return parameters_; }
  bool touching() const { return touching_ > 0; }
  double clearance_m() const { return search_.clearance_m(); }
  std::span<const double> force_n() const { return force_n_; }  ///< normal, of every taxel
  std::span<const int> loaded() const { return loaded_; }       ///< taxels that touch
  /// Of the hand, about the centre of mass; the object's axes.
  const Eigen::Vector3d& force_on_object_n() const { return force_on_object_n_; }
  const Eigen::Vector3d& torque_on_object_nm() const { return torque_on_object_nm_; }
  double normal_force_n(int finger) const { return finger_force_n_[finger + 1]; }  ///< -1: palm
  /// Torque about the first joint a newton of the finger's force.
  double lever_m(int finger) const;
  long clamp_hits() const { return clamp_hits_; }

  /// Greatest speed of a touching place against the object in the last step.
  double fastest_m_per_s() const { return fastest_m_per_s_; }

 private:
  /// As many as lanes, of one body. Force on a taxel:
  /// (normal_n - normal_gain n.v) n + tangent_n - tangent_gain (v - n n.v).
  struct Contacts {
    int taxel[lane_count];
    LaneMask touches;  ///< where not, there is no force
    Lanes3 place_m, normal;
    Lanes depth_m, stiffness_n_per_m, normal_n, normal_gain;
    Lanes3 bristle_m, tangent_n;
    Lanes tangent_k, tangent_gain;

    /// Where there are fewer than lanes, the first one comes again and does not touch.
    Contacts(const HandModel& model, std::span<const Touch> touches, double stiffness_n_per_m3);
    Lanes normal_force_n(const Lanes3& v) const { return normal_n - normal_gain * dot(normal, v); }
    void let_go(int lane);
  };
  /// The palm or a link, and where its contacts are.
  struct Body {
    int finger;
    Twist with_flexion;
    std::size_t first, count;
  };

  std::span<Contacts> of(const Body& body) {
    return std::span(contacts_).subspan(body.first, body.count);
  }
  std::span<const Contacts> of(const Body& body) const {
    return std::span(contacts_).subspan(body.first, body.count);
  }
  void add(const TouchingBody& body, const Twist& motion, const Twist& expected);
  void load(Contacts& contacts, const Lanes3& velocity, const Lanes3& expected) const;
  void rub(Contacts& contacts, Lanes damping_s, const Lanes3& expected) const;
  Lanes3 bristles_m(const Contacts& contacts, const Lanes3& velocity, Lanes rate) const;
  void settle(const Body& body, const Twist& twist, double h);
  void note(const Contacts& contacts, Lanes pressed_n, const Lanes3& creep, double h);

  ContactParameters parameters_;
  const HandModel* model_;
  TaxelSearch search_;
  std::vector<Body> bodies_;
  std::vector<Contacts> contacts_;  ///< body after body
  std::vector<double> force_n_;
  std::vector<Eigen::Vector3d> bristle_m_;  ///< tangential stretch
  std::vector<long> touched_at_;            ///< step in which the taxel last touched
  std::vector<int> loaded_;                 ///< taxels with a force, to be cleared
  std::array<double, finger_count + 1> finger_force_n_{}, finger_torque_nm_{};
  Eigen::Vector3d force_on_object_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_on_object_nm_ = Eigen::Vector3d::Zero();
  double friction_ = 0.0, looked_s_ = 0.0, ahead_s_ = 0.0, fastest_m_per_s_ = 0.0;
  long step_ = 0, clamp_hits_ = 0;
  int touching_ = 0;
};

}  // namespace touchtrace::scene
