#include "pipeline/scene/physics/contact.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scene/physics/contact_sums.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double contact_reach_m = 0.1;  // of most contacts from the centre of mass

Lanes3 velocity_at(const Twist& twist, const Lanes3& point_m) {
  return Lanes3::all(twist.linear) + cross(Lanes3::all(twist.angular), point_m);
}

/// Factor that shortens `v` to `max_length`, 1 if it is shorter. Most contacts stick and need no
/// square root.
Lanes clip_factor(const Lanes3& v, Lanes max_length) {
  const Lanes square = dot(v, v);
  const LaneMask is_longer = square > max_length * max_length;
  return any(is_longer) ? (is_longer ? max_length / sqrt(square) : broadcast(1.0)) : broadcast(1.0);
}

constexpr double max_series_argument = 1.0 / 3;

/// (e^x - 1) / x by its Taylor series; relative error 1e-8 for x from 0 to `max_series_argument`.
Lanes mean_growth_series(Lanes x) {
  const Lanes z = x * x;
  return (1 + x * (1.0 / 2)) +
         z * ((1.0 / 6 + x * (1.0 / 24)) + z * ((1.0 / 120 + x * (1.0 / 720)) + z * (1.0 / 5040)));
}

/// e^x - 1 by four doublings of the argument x / 16. Relative error 5e-8 for x from 0 to
/// 16 `max_series_argument`, 1e-5 for twice that.
Lanes growth(Lanes x) {
  const Lanes y = x * (1.0 / 16);
  Lanes e = y * mean_growth_series(y);
  for (int doubling = 0; doubling < 4; ++doubling) e *= e + 2;
  return e;
}

/// (e^x - 1) / x with the accuracy of growth(). Few contacts deepen enough in a step to need it.
Lanes mean_growth(Lanes x) {
  const LaneMask is_long = x > max_series_argument;
  const Lanes series = mean_growth_series(x);
  return any(is_long) ? (is_long ? growth(x) / x : series) : series;
}

}  // namespace

ContactPatch::ContactPatch(const ContactParameters& parameters, const HandModel& model)
    : parameters_(parameters),
      model_(&model),
      search_(model),
      force_n_(model.taxels.size(), 0.0),
      bristle_m_(model.taxels.size(), Vector3d::Zero()),
      touched_at_(model.taxels.size(), -2) {
  contacts_.reserve(model.taxels.size());
  loaded_.reserve(model.taxels.size());
}

ContactPatch::ContactLanes::ContactLanes(const HandModel& model,
                                         std::span<const TaxelContact> contacts,
                                         double stiffness_n_per_m3) {
  // In registers: loading right after storing lane by lane would stall.
  Lanes3 points_m, normals;
  Lanes depths_m, areas_m2;
  LaneMask are_active;
#pragma GCC unroll 2
  for (int lane = 0; lane < num_lanes; ++lane) {
    const bool exists = lane < std::ssize(contacts);
    const TaxelContact& contact = contacts[exists ? lane : 0];
    taxel[lane] = contact.taxel;
    are_active[lane] = exists ? -1 : 0;
    points_m.set(lane, contact.point_m);
    normals.set(lane, contact.normal);
    depths_m[lane] = contact.depth_m;
    areas_m2[lane] = model.taxels[contact.taxel].area_m2;
  }
  is_active = are_active;
  point_m = points_m, normal = normals;
  depth_m = depths_m, stiffness_n_per_m = stiffness_n_per_m3 * areas_m2;
}

void ContactPatch::ContactLanes::release(int lane) {
  is_active[lane] = 0;
  normal_n[lane] = normal_gain[lane] = tangent_gain[lane] = 0.0;
  tangent_n.set(lane, Vector3d::Zero());
}

void ContactPatch::find(const ObjectSpec& object, const HandInObject& hand,
                        const RelativeMotion& motion, const RelativeMotion& expected,
                        double explicit_s, double implicit_s) {
  links_.clear();
  contacts_.clear();
  num_touching_ = 0;
  explicit_s_ = explicit_s;
  implicit_s_ = implicit_s;
  friction_ = object.friction;
  const double margin_m =
      (implicit_s - explicit_s) *
      (motion.palm.linear.norm() + contact_reach_m * motion.palm.angular.norm() +
       implicit_s * gravity_m_per_s2);
  for (const LinkContacts& link : search_.find(object, hand, margin_m))
    add_link(link, motion.link_twist(link.finger, link.flexion_twist),
             expected.link_twist(link.finger, link.flexion_twist));
}

void ContactPatch::add_link(const LinkContacts& link, const Twist& motion, const Twist& expected) {
  const auto contacts = search_.contacts(link);
  links_.push_back({link.finger, link.flexion_twist, contacts_.size(), 0});
  num_touching_ += static_cast<int>(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); i += num_lanes) {
    ContactLanes& c =
        contacts_.emplace_back(*model_, contacts.subspan(i), parameters_.stiffness_n_per_m3);
    set_normal_force(c, velocity_at(motion, c.point_m), velocity_at(expected, c.point_m));
    for (int lane = 0; lane < num_lanes; ++lane)
      if (!c.is_active[lane]) c.release(lane);
    ++links_.back().count;
  }
}

/// Where contacts deepen, the stiffness is that of the chord to the expected depth. The tangent
/// would predict too little force, and too deep contacts would be thrown out.
void ContactPatch::set_normal_force(ContactLanes& c, const Lanes3& velocity,
                                    const Lanes3& expected) const {
  const ContactParameters& p = parameters_;
  const double per_m = 1.0 / p.hardening_m;
  const Lanes none{}, clamp = broadcast(p.max_depth_m), rate = -dot(c.normal, velocity);
  const Lanes depth = min(c.depth_m, clamp), pressed = max(depth, none),
              reached = min(depth - implicit_s_ * dot(c.normal, expected), clamp);
  const Lanes harder = growth(per_m * pressed);
  Lanes chord = mean_growth(per_m * max(reached - pressed, none));
  if (const LaneMask is_apart = depth < 0.0; any(is_apart)) {  // no hardening before contact
    const Lanes share = max(reached, none) / max(reached - depth, broadcast(1e-12));
    chord = is_apart ? 1 + share * (chord - 1) : chord;
  }
  const Lanes elastic_n = c.stiffness_n_per_m * (min(depth, none) + p.hardening_m * harder);
  const Lanes slope =
      c.stiffness_n_per_m * (1 + harder) * chord * max(1 + p.dissipation_s_per_m * rate, none);
  c.normal_n = elastic_n - explicit_s_ * slope * rate;
  c.normal_gain = implicit_s_ * slope + p.dissipation_s_per_m * max(elastic_n, none);
  c.tangent_k = p.bristle_ratio * c.stiffness_n_per_m;
  c.bristle_m = perpendicular(c.normal, initial_bristles_m(c, velocity, rate));
  set_friction(c, p.dissipation_s_per_m * max(depth, none), expected);
}

/// The Coulomb limit clips the bristle force, and then the sum of bristle force and damping.
void ContactPatch::set_friction(ContactLanes& c, Lanes damping_s, const Lanes3& expected) const {
  const Lanes3 creep = perpendicular(c.normal, expected);
  const Lanes limit_n = friction_ * max(c.normal_force_n(expected), Lanes{});
  const Lanes3 elastic_n = c.tangent_k * (c.bristle_m + broadcast(implicit_s_) * creep);
  const Lanes elastic_share = clip_factor(elastic_n, limit_n);
  const Lanes damping = c.tangent_k * damping_s;
  const Lanes share = clip_factor(elastic_share * elastic_n + damping * creep, limit_n);
  c.tangent_gain = share * (elastic_share * c.tangent_k * implicit_s_ + damping);
  c.tangent_n = -(share * elastic_share * c.tangent_k) * c.bristle_m;
}

/// Bristle deflections at the start of the step. A taxel that has just touched has been deflected
/// since its depth was 0.
Lanes3 ContactPatch::initial_bristles_m(const ContactLanes& c, const Lanes3& velocity,
                                        Lanes rate) const {
  const LaneMask entered = (c.depth_m > 0.0) & (c.depth_m < 2 * explicit_s_ * rate);
  LaneMask is_old;
  Lanes3 old_m;
#pragma GCC unroll 2
  for (int lane = 0; lane < num_lanes; ++lane) {
    is_old[lane] = touched_at_[c.taxel[lane]] >= step_ ? -1 : 0;
    old_m.set(lane, bristle_m_[c.taxel[lane]]);
  }
  return select(is_old, old_m, (entered ? c.depth_m / rate - explicit_s_ : Lanes{}) * velocity);
}

void ContactPatch::add_to(MotionSystem& system, const Twist& imposed) const {
  Matrix6d total_resistance = Matrix6d::Zero();
  Vector6d total_bias = Vector6d::Zero();
  for (const Link& link : links_) {
    ContactSums sums;
    for (const ContactLanes& c : contacts_of(link))
      sums.add(c.point_m, c.normal, c.normal_n, c.tangent_n, c.normal_gain - c.tangent_gain,
               c.tangent_gain);
    const Matrix6d resistance = implicit_s_ * sums.resistance();
    const Vector6d bias = implicit_s_ * sums.bias() - resistance * stack(imposed);
    if (link.finger >= 0) add_to_finger(system, link.finger, link.flexion_twist, resistance, bias);
    total_resistance += resistance;
    total_bias += bias;
  }
  add_to_bodies(system, total_resistance, total_bias);
}

bool ContactPatch::release_tensile(const RelativeMotion& motion) {
  const int before = num_touching_;
  for (const Link& link : links_) {
    const Twist twist = motion.link_twist(link.finger, link.flexion_twist);
    for (ContactLanes& c : contacts_of(link)) {
      const Lanes force_n = c.normal_force_n(velocity_at(twist, c.point_m));
      for (int lane = 0; lane < num_lanes; ++lane)
        if (force_n[lane] < 0.0) c.release(lane), --num_touching_;
    }
  }
  return num_touching_ < before;
}

void ContactPatch::finish_step(const RelativeMotion& motion, double h) {
  ++step_;
  for (int taxel : loaded_) force_n_[taxel] = 0.0;
  loaded_.clear();
  finger_force_n_.fill(0.0);
  finger_torque_nm_.fill(0.0);
  force_on_object_n_.setZero();
  torque_on_object_nm_.setZero();
  max_speed_m_per_s_ = 0.0;
  for (const Link& link : links_)
    finish_link(link, motion.link_twist(link.finger, link.flexion_twist), h);
}

void ContactPatch::finish_link(const Link& link, const Twist& twist, double h) {
  Lanes3 force_n{}, torque_nm{};
  Lanes speed2{}, normal_n{}, flexion_nm{};
  for (ContactLanes& c : contacts_of(link)) {
    const Lanes3 velocity = velocity_at(twist, c.point_m),
                 creep = perpendicular(c.normal, velocity);
    const Lanes pressed_n = max(c.normal_force_n(velocity), Lanes{});
    const Lanes3 on_taxel = pressed_n * c.normal + c.tangent_n - c.tangent_gain * creep;
    force_n += on_taxel;
    torque_nm += cross(c.point_m, on_taxel);
    normal_n += pressed_n;
    flexion_nm += pressed_n * dot(c.normal, velocity_at(link.flexion_twist, c.point_m));
    speed2 = max(speed2, c.is_active ? dot(velocity, velocity) : Lanes{});
    store(c, pressed_n, creep, h);
  }
  force_on_object_n_ -= sum(force_n);
  torque_on_object_nm_ -= sum(torque_nm);
  max_speed_m_per_s_ = std::max({max_speed_m_per_s_, std::sqrt(speed2[0]), std::sqrt(speed2[1])});
  finger_force_n_[link.finger + 1] += sum(normal_n);
  finger_torque_nm_[link.finger + 1] -= sum(flexion_nm);
}

/// Stores force and new bristle deflection of each active lane's taxel.
void ContactPatch::store(const ContactLanes& c, Lanes pressed_n, const Lanes3& creep, double h) {
  Lanes3 bristle = c.bristle_m + broadcast(implicit_s_) * creep;
  bristle = clip_factor(bristle, friction_ * pressed_n / c.tangent_k) * bristle +
            broadcast(h - implicit_s_) * creep;
  for (int lane = 0; lane < num_lanes; ++lane) {
    if (!c.is_active[lane]) continue;
    const int taxel = c.taxel[lane];
    if (c.depth_m[lane] > parameters_.max_depth_m) ++num_clamped_;
    bristle_m_[taxel] = bristle.at(lane);
    touched_at_[taxel] = step_;
    force_n_[taxel] = pressed_n[lane];
    loaded_.push_back(taxel);
  }
}

double ContactPatch::lever_m(int finger) const {
  const double force = finger_force_n_[finger + 1];
  return force > 0.0 ? finger_torque_nm_[finger + 1] / force : 0.0;
}

}  // namespace touchtrace::scene
