#include "pipeline/scene/contact.h"

#include <algorithm>

#include "pipeline/scene/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// Upper bounds: of a taxel's distance from the middle of the palm, and of its way a radian of
// flexion.
constexpr double hand_reach_m = 0.18, finger_reach_m = 0.20;

}  // namespace

/// One link seen from the object, and the way back to the world.
struct ContactPatch::Frame {
  Matrix3d object_from_link;
  Vector3d link_in_object;
  Matrix3d world_from_object, world_from_hand;
  const FingerPose* pose;
};

ContactPatch::ContactPatch(const ContactParameters& parameters)
    : parameters_(parameters),
      force_n_(hand_model().taxels.size(), 0.0),
      bristle_m_(hand_model().taxels.size(), Vector3d::Zero()),
      touched_at_(hand_model().taxels.size(), -2),
      taxel_free_until_m_(hand_model().taxels.size(), 0.0),
      group_free_until_m_(hand_model().groups.size(), 0.0) {
  contacts_.reserve(hand_model().taxels.size());
  loaded_.reserve(hand_model().taxels.size());
}

void ContactPatch::find(const ContactScene& scene, double h) {
  const HandModel& hand = hand_model();
  contacts_.clear();
  friction_ = scene.spec.friction;
  ++step_;
  clearance_m_ = 1.0;
  const Matrix3d world_from_hand = scene.hand.orientation.toRotationMatrix();
  const Matrix3d world_from_object = scene.object.orientation.toRotationMatrix();
  const Matrix3d object_from_hand = world_from_object.transpose() * world_from_hand;
  const Vector3d hand_in_object =
      world_from_object.transpose() * (scene.hand.position_m - scene.object.position_m);
  std::array<FingerPose, finger_count> poses;
  for (int i = 0; i < finger_count; ++i)
    poses[i] = pose_finger(hand.fingers[i], scene.flexion_rad[i]);
  follow(object_from_hand, hand_in_object, scene.flexion_rad);
  for (const TaxelGroup& group : hand.groups) {
    Frame frame{object_from_hand, hand_in_object, world_from_object, world_from_hand, nullptr};
    if (group.finger >= 0) {
      frame.pose = &poses[group.finger];
      frame.object_from_link = object_from_hand * frame.pose->hand_from_link[group.link];
      frame.link_in_object += object_from_hand * frame.pose->joint_m[group.link];
    }
    search(group, frame, scene, h);
  }
}

void ContactPatch::search(const TaxelGroup& group, const Frame& frame, const ContactScene& scene,
                          double h) {
  const Vector3d centre = frame.object_from_link * group.centre_m + frame.link_in_object;
  const double travel = travel_m_[group.finger + 1];
  double& free_until = group_free_until_m_[&group - hand_model().groups.data()];
  if (travel >= free_until) free_until = travel + distance_m(scene.spec, centre) - group.radius_m;
  clearance_m_ = std::clamp(free_until - travel, 0.0, clearance_m_);
  if (travel < free_until) return;
  for (int i = group.first; i < group.first + group.count; ++i) {
    if (travel < taxel_free_until_m_[i]) continue;
    const Vector3d point =
        frame.object_from_link * hand_model().taxels[i].position_m + frame.link_in_object;
    const double d = distance_m(scene.spec, point);
    if (d < 0.0)
      touch(i, group, point, frame, scene, h);
    else
      taxel_free_until_m_[i] = travel + d;
  }
}

/// Distances change no faster than their points move, so a taxel that was clear by d need not be
/// looked at until it may have moved by d against the object.
void ContactPatch::follow(const Matrix3d& object_from_hand, const Vector3d& hand_in_object,
                          const std::array<double, finger_count>& flexion_rad) {
  const double moved = (hand_in_object - last_hand_in_object_).norm() +
                       hand_reach_m * (object_from_hand - last_object_from_hand_).norm();
  for (double& travel : travel_m_) travel += moved;
  for (int i = 0; i < finger_count; ++i)
    travel_m_[i + 1] += finger_reach_m * std::abs(flexion_rad[i] - last_flexion_rad_[i]);
  last_hand_in_object_ = hand_in_object;
  last_object_from_hand_ = object_from_hand;
  last_flexion_rad_ = flexion_rad;
}

void ContactPatch::touch(int taxel, const TaxelGroup& group, const Vector3d& point,
                         const Frame& frame, const ContactScene& scene, double h) {
  const Distance d = distance(scene.spec, point);
  Contact& c = contacts_.emplace_back();
  c.taxel = taxel;
  c.finger = group.finger;
  c.normal = frame.world_from_object * d.normal;
  c.from_object = frame.world_from_object * point;
  c.from_hand = c.from_object + scene.object.position_m - scene.hand.position_m;
  c.with_flexion.setZero();
  if (frame.pose) {
    const Vector3d in_hand = frame.world_from_hand.transpose() * c.from_hand;
    const Finger& finger = hand_model().fingers[group.finger];
    c.with_flexion = frame.world_from_hand * frame.pose->jacobian(finger, group.link, in_hand);
  }
  load(c, -d.value_m, scene, h);
}

void ContactPatch::load(Contact& c, double depth, const ContactScene& scene, double h) {
  const ContactParameters& p = parameters_;
  if (depth > p.clamp_m) ++clamp_hits_, depth = p.clamp_m;
  const double k = p.stiffness_n_per_m3 * hand_model().taxels[c.taxel].area_m2;
  const Vector3d velocity = slide(c, scene.velocity, scene.hand_spin);
  const double rate = -c.normal.dot(velocity);
  c.elastic_n = k * depth * (1 + depth / p.hardening_m);
  const double slope =
      k * (1 + 2 * depth / p.hardening_m) * std::max(0.0, 1 + p.dissipation_s_per_m * rate);
  c.rate_gain = h * slope + c.elastic_n * p.dissipation_s_per_m;
  const double normal_force = std::max(0.0, c.elastic_n + c.rate_gain * rate);
  rub(c, p.bristle_ratio * k, p.dissipation_s_per_m * depth, velocity + c.normal * rate,
      normal_force, h);
  c.push -= c.resistance * scene.hand_spin.cross(c.from_hand);
}

void ContactPatch::rub(Contact& c, double stiffness, double damping_s, const Vector3d& creep,
                       double normal_force, double h) {
  Vector3d& bristle = bristle_m_[c.taxel];
  if (touched_at_[c.taxel] != step_ - 1) bristle.setZero();
  touched_at_[c.taxel] = step_;
  bristle -= c.normal * c.normal.dot(bristle);
  c.tangent_k = stiffness;
  c.tangent_c = stiffness * damping_s;
  const double pull = (c.tangent_k * (bristle + h * creep) + c.tangent_c * creep).norm();
  c.tangent_share = std::min(1.0, friction_ * normal_force / std::max(pull, 1e-12));
  const double gain = c.tangent_share * (h * c.tangent_k + c.tangent_c);
  c.resistance =
      gain * Matrix3d::Identity() + (c.rate_gain - gain) * c.normal * c.normal.transpose();
  c.push = c.elastic_n * c.normal - c.tangent_share * c.tangent_k * bristle;
}

void ContactPatch::add_to(ContactSystem& system, ContactVelocity& momentum, double h) const {
  Matrix3d shift = Matrix3d::Zero(), mixed = Matrix3d::Zero(), turn = Matrix3d::Zero();
  for (const Contact& c : contacts_) {
    const Matrix3d arm = cross_matrix(c.from_object);
    const Matrix3d resistance_arm = c.resistance * arm;
    shift += c.resistance;
    mixed += resistance_arm;
    turn -= arm * resistance_arm;
    momentum.segment<3>(hand_at) += h * c.push;
    momentum.segment<3>(object_at) -= h * c.push;
    momentum.segment<3>(spin_at) -= h * c.from_object.cross(c.push);
    if (c.finger < 0) continue;
    const int f = fingers_at + c.finger;
    const Vector3d column = h * c.resistance * c.with_flexion;
    momentum[f] += h * c.with_flexion.dot(c.push);
    system(f, f) += c.with_flexion.dot(column);
    system.block<1, 3>(f, hand_at) += column.transpose();
    system.block<1, 3>(f, object_at) -= column.transpose();
    system.block<1, 3>(f, spin_at) += column.transpose() * arm;
  }
  system.block<3, 3>(hand_at, hand_at) += h * shift;
  system.block<3, 3>(object_at, hand_at) -= h * shift;
  system.block<3, 3>(object_at, object_at) += h * shift;
  system.block<3, 3>(spin_at, hand_at) += h * mixed.transpose();
  system.block<3, 3>(spin_at, object_at) -= h * mixed.transpose();
  system.block<3, 3>(spin_at, spin_at) += h * turn;
}

Vector3d ContactPatch::slide(const Contact& c, const ContactVelocity& next,
                             const Vector3d& hand_spin) {
  Vector3d velocity = next.segment<3>(hand_at) + hand_spin.cross(c.from_hand) -
                      next.segment<3>(object_at) - next.segment<3>(spin_at).cross(c.from_object);
  if (c.finger >= 0) velocity += next[fingers_at + c.finger] * c.with_flexion;
  return velocity;
}

bool ContactPatch::part(const ContactVelocity& next, const Vector3d& hand_spin) {
  return std::erase_if(contacts_, [&](const Contact& c) {
           return c.elastic_n < c.rate_gain * c.normal.dot(slide(c, next, hand_spin));
         }) > 0;
}

void ContactPatch::settle(const ContactVelocity& next, const Vector3d& hand_spin, double h) {
  for (int taxel : loaded_) force_n_[taxel] = 0.0;
  loaded_.clear();
  finger_force_n_.fill(0.0);
  finger_torque_nm_.fill(0.0);
  force_on_object_n_.setZero();
  torque_on_object_nm_.setZero();
  for (const Contact& c : contacts_) {
    apply(c, slide(c, next, hand_spin), h);
    Vector3d& bristle = bristle_m_[c.taxel];
    bristle += h * hand_spin.cross(bristle);
  }
}

void ContactPatch::apply(const Contact& c, const Vector3d& velocity, double h) {
  const double rate = -c.normal.dot(velocity);
  const double normal_force = std::max(0.0, c.elastic_n + c.rate_gain * rate);
  const Vector3d creep = velocity + c.normal * rate;
  Vector3d& bristle = bristle_m_[c.taxel];
  const Vector3d friction =
      -c.tangent_share * (c.tangent_k * (bristle + h * creep) + c.tangent_c * creep);
  bristle += h * creep;
  const double longest = friction_ * normal_force / c.tangent_k;
  if (const double length = bristle.norm(); length > longest) bristle *= longest / length;

  force_n_[c.taxel] = normal_force;
  loaded_.push_back(c.taxel);
  const Vector3d on_taxel = normal_force * c.normal + friction;
  force_on_object_n_ -= on_taxel;
  torque_on_object_nm_ -= c.from_object.cross(on_taxel);
  finger_force_n_[c.finger + 1] += normal_force;
  finger_torque_nm_[c.finger + 1] -= normal_force * c.normal.dot(c.with_flexion);
}

double ContactPatch::lever_m(int finger) const {
  const double force = finger_force_n_[finger + 1];
  return force > 0.0 ? finger_torque_nm_[finger + 1] / force : 0.0;
}

}  // namespace touchtrace::scene
