#pragma once

#include "pipeline/scene/base/parameters.h"
#include "pipeline/scene/physics/contact_search.h"
#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {

/// How the hand moves against the object, in the object's axes: a place p of the hand by
/// linear + angular x p, and by the flexion of its finger.
struct RelativeMotion {
  Eigen::Vector3d linear_m_per_s, angular_rad_per_s;
  FingerRates flexion_rad_per_s;

  Eigen::Vector3d at(const Touch& touch) const {
    Eigen::Vector3d v = linear_m_per_s + angular_rad_per_s.cross(touch.place_m);
    if (touch.finger >= 0) v += flexion_rad_per_s[touch.finger] * touch.with_flexion;
    return v;
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
  /// left side, the rest to its right. `imposed` is the motion that is not solved for.
  void add_to(MotionSystem& system, const RelativeMotion& imposed) const;
  /// Lets go of contacts that would have to pull at the velocities solved for; true if there were
  /// any, and the system has to be solved again without them.
  bool part(const RelativeMotion& motion);
  /// With the velocities solved for, and a step of `h`: forces of every taxel, friction states,
  /// sums.
  void settle(const RelativeMotion& motion, double h);

  bool touching() const { return !contacts_.empty(); }
  double clearance_m() const { return search_.clearance_m(); }
  std::span<const double> force_n() const { return force_n_; }  ///< normal, of every taxel
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
  /// Force on the taxel: (normal_n - normal_gain n.v) n + tangent_n - tangent_gain (v - n n.v).
  struct Contact {
    Touch touch;
    double normal_n, normal_gain;
    Eigen::Vector3d tangent_n;
    double tangent_gain, tangent_k;

    double normal_force_n(const Eigen::Vector3d& v) const {
      return normal_n - normal_gain * touch.normal.dot(v);
    }
  };

  void load(const Touch& touch, const Eigen::Vector3d& velocity, const Eigen::Vector3d& expected);
  void rub(Contact& contact, double damping_s, const Eigen::Vector3d& velocity, double rate,
           const Eigen::Vector3d& expected);
  void apply(const Contact& contact, const Eigen::Vector3d& velocity, double h);

  ContactParameters parameters_;
  const HandModel* model_;
  TaxelSearch search_;
  std::vector<Contact> contacts_;
  std::vector<double> force_n_;
  std::vector<Eigen::Vector3d> bristle_m_;  ///< tangential stretch
  std::vector<long> touched_at_;            ///< step in which the taxel last touched
  std::vector<int> loaded_;                 ///< taxels with a force, to be cleared
  std::array<double, finger_count + 1> finger_force_n_{}, finger_torque_nm_{};
  Eigen::Vector3d force_on_object_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_on_object_nm_ = Eigen::Vector3d::Zero();
  double friction_ = 0.0, looked_s_ = 0.0, ahead_s_ = 0.0, fastest_m_per_s_ = 0.0;
  long step_ = 0, clamp_hits_ = 0;
};

}  // namespace touchtrace::scene
