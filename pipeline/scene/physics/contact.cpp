#include "pipeline/scene/physics/contact.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scene/physics/contact_sums.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double contact_reach_m = 0.1;  // of most touching places from the centre of mass

Lanes3 velocity_of(const Twist& twist, const Lanes3& place_m) {
  return Lanes3::all(twist.linear) + cross(Lanes3::all(twist.angular), place_m);
}

/// 1, or less where `v` has to be shortened to `longest`. Most contacts stick: they need no root.
Lanes clip(const Lanes3& v, Lanes longest) {
  const Lanes square = dot(v, v);
  const LaneMask is_longer = square > longest * longest;
  return any(is_longer) ? (is_longer ? longest / root(square) : all_lanes(1.0)) : all_lanes(1.0);
}

constexpr double series_end = 1.0 / 3;

/// (e^x - 1) / x by Taylor's series: to 1e-8 of itself for x from 0 to `series_end`.
Lanes mean_growth_by_series(Lanes x) {
  const Lanes z = x * x;
  return (1 + x * (1.0 / 2)) +
         z * ((1.0 / 6 + x * (1.0 / 24)) + z * ((1.0 / 120 + x * (1.0 / 720)) + z * (1.0 / 5040)));
}

/// e^x - 1, doubled four times from x / 16: to 5e-8 of itself for x from 0 to 16 `series_end`, 1e-5
/// for twice that.
Lanes growth(Lanes x) {
  const Lanes y = x * (1.0 / 16);
  Lanes e = y * mean_growth_by_series(y);
  for (int doubling = 0; doubling < 4; ++doubling) e *= e + 2;
  return e;
}

/// (e^x - 1) / x, as well. Few contacts get much deeper in a step.
Lanes mean_growth(Lanes x) {
  const LaneMask is_long = x > series_end;
  const Lanes by_series = mean_growth_by_series(x);
  return any(is_long) ? (is_long ? growth(x) / x : by_series) : by_series;
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

ContactPatch::Contacts::Contacts(const HandModel& model, std::span<const Touch> from,
                                 double stiffness_n_per_m3) {
  // In registers: loading at once what was just stored lane by lane would take long.
  Lanes3 places_m, normals;
  Lanes depths_m, areas_m2;
  LaneMask are_real;
#pragma GCC unroll 2
  for (int lane = 0; lane < lane_count; ++lane) {
    const bool is_real = lane < std::ssize(from);
    const Touch& touch = from[is_real ? lane : 0];
    taxel[lane] = touch.taxel;
    are_real[lane] = is_real ? -1 : 0;
    places_m.set(lane, touch.place_m);
    normals.set(lane, touch.normal);
    depths_m[lane] = touch.depth_m;
    areas_m2[lane] = model.taxels[touch.taxel].area_m2;
  }
  touches = are_real;
  place_m = places_m, normal = normals;
  depth_m = depths_m, stiffness_n_per_m = stiffness_n_per_m3 * areas_m2;
}

void ContactPatch::Contacts::let_go(int lane) {
  touches[lane] = 0;
  normal_n[lane] = normal_gain[lane] = tangent_gain[lane] = 0.0;
  tangent_n.set(lane, Vector3d::Zero());
}

void ContactPatch::find(const ObjectSpec& object, const HandFromObject& hand,
                        const RelativeMotion& motion, const RelativeMotion& expected,
                        double looked_s, double ahead_s) {
  bodies_.clear();
  contacts_.clear();
  touching_ = 0;
  looked_s_ = looked_s;
  ahead_s_ = ahead_s;
  friction_ = object.friction;
  const double margin_m = (ahead_s - looked_s) * (motion.palm.linear.norm() +
                                                  contact_reach_m * motion.palm.angular.norm() +
                                                  ahead_s * gravity_m_per_s2);
  for (const TouchingBody& body : search_.find(object, hand, margin_m))
    add(body, motion.of(body.finger, body.with_flexion),
        expected.of(body.finger, body.with_flexion));
}

void ContactPatch::add(const TouchingBody& body, const Twist& motion, const Twist& expected) {
  const auto touches = search_.touches(body);
  bodies_.push_back({body.finger, body.with_flexion, contacts_.size(), 0});
  touching_ += static_cast<int>(touches.size());
  for (std::size_t i = 0; i < touches.size(); i += lane_count) {
    Contacts& c =
        contacts_.emplace_back(*model_, touches.subspan(i), parameters_.stiffness_n_per_m3);
    load(c, velocity_of(motion, c.place_m), velocity_of(expected, c.place_m));
    for (int lane = 0; lane < lane_count; ++lane)
      if (!c.touches[lane]) c.let_go(lane);
    ++bodies_.back().count;
  }
}

/// Where contacts get deeper, stiffness is that of the chord to where they are expected to get. The
/// tangent there foresees too little force, and what gets too deep is thrown out again.
void ContactPatch::load(Contacts& c, const Lanes3& velocity, const Lanes3& expected) const {
  const ContactParameters& p = parameters_;
  const double per_m = 1.0 / p.hardening_m;
  const Lanes none{}, clamp = all_lanes(p.clamp_m), rate = -dot(c.normal, velocity);
  const Lanes depth = smallest(c.depth_m, clamp), pressed = largest(depth, none),
              reached = smallest(depth - ahead_s_ * dot(c.normal, expected), clamp);
  const Lanes harder = growth(per_m * pressed);
  Lanes chord = mean_growth(per_m * largest(reached - pressed, none));
  if (const LaneMask is_apart = depth < 0.0; any(is_apart)) {  // until then nothing hardens
    const Lanes share = largest(reached, none) / largest(reached - depth, all_lanes(1e-12));
    chord = is_apart ? 1 + share * (chord - 1) : chord;
  }
  const Lanes elastic_n = c.stiffness_n_per_m * (smallest(depth, none) + p.hardening_m * harder);
  const Lanes slope =
      c.stiffness_n_per_m * (1 + harder) * chord * largest(1 + p.dissipation_s_per_m * rate, none);
  c.normal_n = elastic_n - looked_s_ * slope * rate;
  c.normal_gain = ahead_s_ * slope + p.dissipation_s_per_m * largest(elastic_n, none);
  c.tangent_k = p.bristle_ratio * c.stiffness_n_per_m;
  c.bristle_m = across(c.normal, bristles_m(c, velocity, rate));
  rub(c, p.dissipation_s_per_m * largest(depth, none), expected);
}

/// Coulomb's limit clips the bristle, and then what bristle and damping pull together.
void ContactPatch::rub(Contacts& c, Lanes damping_s, const Lanes3& expected) const {
  const Lanes3 creep = across(c.normal, expected);
  const Lanes limit_n = friction_ * largest(c.normal_force_n(expected), Lanes{});
  const Lanes3 elastic_n = c.tangent_k * (c.bristle_m + all_lanes(ahead_s_) * creep);
  const Lanes elastic_share = clip(elastic_n, limit_n);
  const Lanes damping = c.tangent_k * damping_s;
  const Lanes share = clip(elastic_share * elastic_n + damping * creep, limit_n);
  c.tangent_gain = share * (elastic_share * c.tangent_k * ahead_s_ + damping);
  c.tangent_n = -(share * elastic_share * c.tangent_k) * c.bristle_m;
}

/// A taxel that was clear before has been stretched since its depth was 0.
Lanes3 ContactPatch::bristles_m(const Contacts& c, const Lanes3& velocity, Lanes rate) const {
  const LaneMask entered = (c.depth_m > 0.0) & (c.depth_m < 2 * looked_s_ * rate);
  LaneMask is_old;
  Lanes3 old_m;
#pragma GCC unroll 2
  for (int lane = 0; lane < lane_count; ++lane) {
    is_old[lane] = touched_at_[c.taxel[lane]] >= step_ ? -1 : 0;
    old_m.set(lane, bristle_m_[c.taxel[lane]]);
  }
  return choose(is_old, old_m, (entered ? c.depth_m / rate - looked_s_ : Lanes{}) * velocity);
}

void ContactPatch::add_to(MotionSystem& system, const Twist& imposed) const {
  Matrix6d all_resistance = Matrix6d::Zero();
  Vector6d all_push = Vector6d::Zero();
  for (const Body& body : bodies_) {
    ContactSums sums;
    for (const Contacts& c : of(body))
      sums.add(c.place_m, c.normal, c.normal_n, c.tangent_n, c.normal_gain - c.tangent_gain,
               c.tangent_gain);
    const Matrix6d resistance = ahead_s_ * sums.resistance();
    const Vector6d push = ahead_s_ * sums.push() - resistance * joined(imposed);
    if (body.finger >= 0) add_to_finger(system, body.finger, body.with_flexion, resistance, push);
    all_resistance += resistance;
    all_push += push;
  }
  add_to_bodies(system, all_resistance, all_push);
}

bool ContactPatch::part(const RelativeMotion& motion) {
  const int before = touching_;
  for (const Body& body : bodies_) {
    const Twist twist = motion.of(body.finger, body.with_flexion);
    for (Contacts& c : of(body)) {
      const Lanes force_n = c.normal_force_n(velocity_of(twist, c.place_m));
      for (int lane = 0; lane < lane_count; ++lane)
        if (force_n[lane] < 0.0) c.let_go(lane), --touching_;
    }
  }
  return touching_ < before;
}

void ContactPatch::settle(const RelativeMotion& motion, double h) {
  ++step_;
  for (int taxel : loaded_) force_n_[taxel] = 0.0;
  loaded_.clear();
  finger_force_n_.fill(0.0);
  finger_torque_nm_.fill(0.0);
  force_on_object_n_.setZero();
  torque_on_object_nm_.setZero();
  fastest_m_per_s_ = 0.0;
  for (const Body& body : bodies_) settle(body, motion.of(body.finger, body.with_flexion), h);
}

void ContactPatch::settle(const Body& body, const Twist& twist, double h) {
  Lanes3 force_n{}, torque_nm{};
  Lanes speed2{}, normal_n{}, flexion_nm{};
  for (Contacts& c : of(body)) {
    const Lanes3 velocity = velocity_of(twist, c.place_m), creep = across(c.normal, velocity);
    const Lanes pressed_n = largest(c.normal_force_n(velocity), Lanes{});
    const Lanes3 on_taxel = pressed_n * c.normal + c.tangent_n - c.tangent_gain * creep;
    force_n += on_taxel;
    torque_nm += cross(c.place_m, on_taxel);
    normal_n += pressed_n;
    flexion_nm += pressed_n * dot(c.normal, velocity_of(body.with_flexion, c.place_m));
    speed2 = largest(speed2, c.touches ? dot(velocity, velocity) : Lanes{});
    note(c, pressed_n, creep, h);
  }
  force_on_object_n_ -= sum(force_n);
  torque_on_object_nm_ -= sum(torque_nm);
  fastest_m_per_s_ = std::max({fastest_m_per_s_, std::sqrt(speed2[0]), std::sqrt(speed2[1])});
  finger_force_n_[body.finger + 1] += sum(normal_n);
  finger_torque_nm_[body.finger + 1] -= sum(flexion_nm);
}

void ContactPatch::note(const Contacts& c, Lanes pressed_n, const Lanes3& creep, double h) {
  Lanes3 bristle = c.bristle_m + all_lanes(ahead_s_) * creep;
  bristle = clip(bristle, friction_ * pressed_n / c.tangent_k) * bristle +
            all_lanes(h - ahead_s_) * creep;
  for (int lane = 0; lane < lane_count; ++lane) {
    if (!c.touches[lane]) continue;
    const int taxel = c.taxel[lane];
    if (c.depth_m[lane] > parameters_.clamp_m) ++clamp_hits_;
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
