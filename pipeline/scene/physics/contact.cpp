#include "pipeline/scene/physics/contact.h"

#include <algorithm>

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double contact_reach_m = 0.1;  // of most touching places from the centre of mass

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Sums over contacts that make the relative motion's 6 x 6 block: of w w' with w = (n, p x n), of
/// the isotropic parts, and of the forces at rest.
struct ContactSums {
  Eigen::Matrix<double, 6, 6> along = Eigen::Matrix<double, 6, 6>::Zero();
  double gain = 0.0;
  Vector3d moment = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();

  void add(const Vector3d& place, const Vector3d& normal, double extra, double isotropic,
           const Vector3d& push) {
    Eigen::Matrix<double, 6, 1> w;
    w << normal, place.cross(normal);
    along.noalias() += (extra * w) * w.transpose();
    gain += isotropic;
    moment += isotropic * place;
    second.noalias() += (isotropic * place) * place.transpose();
    force += push;
    torque += place.cross(push);
  }

  void add_to(MotionSystem& system, double ahead_s) const {
    const Matrix3d turned = ahead_s * (along.bottomLeftCorner<3, 3>() + cross_matrix(moment));
    const Matrix3d shift = ahead_s * (along.topLeftCorner<3, 3>() + gain * Matrix3d::Identity());
    system.bodies.block<3, 3>(hand_at, hand_at) += shift;
    system.bodies.block<3, 3>(object_at, hand_at) -= shift;
    system.bodies.block<3, 3>(object_at, object_at) += shift;
    system.bodies.block<3, 3>(spin_at, hand_at) -= turned;
    system.bodies.block<3, 3>(spin_at, object_at) += turned;
    system.bodies.block<3, 3>(spin_at, spin_at) +=
        ahead_s *
        (along.bottomRightCorner<3, 3>() + second.trace() * Matrix3d::Identity() - second);
    system.momentum.segment<3>(hand_at) += ahead_s * force;
    system.momentum.segment<3>(object_at) -= ahead_s * force;
    system.momentum.segment<3>(spin_at) -= ahead_s * torque;
  }
};

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

void ContactPatch::find(const ObjectSpec& object, const HandFromObject& hand,
                        const RelativeMotion& motion, const RelativeMotion& expected,
                        double looked_s, double ahead_s) {
  contacts_.clear();
  looked_s_ = looked_s;
  ahead_s_ = ahead_s;
  friction_ = object.friction;
  const double margin_m =
      (ahead_s - looked_s) *
      (motion.linear_m_per_s.norm() + contact_reach_m * motion.angular_rad_per_s.norm() +
       ahead_s * gravity_m_per_s2);
  for (const Touch& touch : search_.find(object, hand, margin_m))
    load(touch, motion.at(touch), expected.at(touch));
}

void ContactPatch::load(const Touch& touch, const Vector3d& velocity, const Vector3d& expected) {
  const ContactParameters& p = parameters_;
  const double depth = std::min(touch.depth_m, p.clamp_m);
  const double k = p.stiffness_n_per_m3 * model_->taxels[touch.taxel].area_m2;
  const double rate = -touch.normal.dot(velocity);
  const double hardening = std::max(0.0, depth) / p.hardening_m;
  const double elastic_n = k * depth * (1 + hardening);
  const double slope = k * (1 + 2 * hardening) * std::max(0.0, 1 + p.dissipation_s_per_m * rate);
  Contact& c = contacts_.emplace_back();
  c.touch = touch;
  c.normal_n = elastic_n - looked_s_ * slope * rate;
  c.normal_gain = ahead_s_ * slope + std::max(0.0, elastic_n) * p.dissipation_s_per_m;
  c.tangent_k = p.bristle_ratio * k;
  rub(c, p.dissipation_s_per_m * std::max(0.0, depth), velocity, rate, expected);
}

/// A taxel that was clear before has been stretched since its depth was 0. Coulomb's limit clips
/// the bristle, and then what bristle and damping pull together.
void ContactPatch::rub(Contact& c, double damping_s, const Vector3d& velocity, double rate,
                       const Vector3d& expected) {
  const Vector3d& normal = c.touch.normal;
  Vector3d& bristle = bristle_m_[c.touch.taxel];
  if (touched_at_[c.touch.taxel] < step_) {
    const bool entered = c.touch.depth_m > 0.0 && c.touch.depth_m < 2 * looked_s_ * rate;
    bristle = (entered ? c.touch.depth_m / rate - looked_s_ : 0.0) * velocity;
  }
  bristle -= normal * normal.dot(bristle);
  const Vector3d creep = expected - normal * normal.dot(expected);
  const double limit_n = friction_ * std::max(0.0, c.normal_force_n(expected));
  const auto clip = [&](const Vector3d& force_n) {
    const double size = force_n.norm();
    return size > limit_n ? limit_n / size : 1.0;
  };
  const Vector3d elastic_n = c.tangent_k * (bristle + ahead_s_ * creep);
  const double elastic_share = clip(elastic_n);
  const double damping = c.tangent_k * damping_s;
  const double share = clip(elastic_share * elastic_n + damping * creep);
  c.tangent_gain = share * (elastic_share * c.tangent_k * ahead_s_ + damping);
  c.tangent_n = -share * elastic_share * c.tangent_k * bristle;
}

void ContactPatch::add_to(MotionSystem& system, const RelativeMotion& imposed) const {
  ContactSums sums;
  for (const Contact& c : contacts_) {
    const Vector3d& n = c.touch.normal;
    const double extra = c.normal_gain - c.tangent_gain;
    const Vector3d known = imposed.at(c.touch);
    const Vector3d push =
        (c.normal_n - extra * n.dot(known)) * n + c.tangent_n - c.tangent_gain * known;
    sums.add(c.touch.place_m, n, extra, c.tangent_gain, push);
    if (c.touch.finger < 0) continue;
    const Vector3d& way = c.touch.with_flexion;
    const Vector3d column = ahead_s_ * (c.tangent_gain * way + extra * n.dot(way) * n);
    auto bodies = system.columns.col(c.touch.finger);
    bodies.segment<3>(hand_at) += column;
    bodies.segment<3>(object_at) -= column;
    bodies.segment<3>(spin_at) -= c.touch.place_m.cross(column);
    system.fingers[c.touch.finger] += way.dot(column);
    system.momentum[fingers_at + c.touch.finger] += ahead_s_ * way.dot(push);
  }
  sums.add_to(system, ahead_s_);
}

bool ContactPatch::part(const RelativeMotion& motion) {
  return std::erase_if(contacts_, [&](const Contact& c) {
           return c.normal_force_n(motion.at(c.touch)) < 0.0;
         }) > 0;
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
  for (const Contact& c : contacts_) {
    if (c.touch.depth_m > parameters_.clamp_m) ++clamp_hits_;
    const Vector3d velocity = motion.at(c.touch);
    fastest_m_per_s_ = std::max(fastest_m_per_s_, velocity.norm());
    apply(c, velocity, h);
  }
}

void ContactPatch::apply(const Contact& c, const Vector3d& velocity, double h) {
  const Touch& at = c.touch;
  const double normal_force = std::max(0.0, c.normal_force_n(velocity));
  const Vector3d creep = velocity - at.normal * at.normal.dot(velocity);
  const Vector3d on_taxel = normal_force * at.normal + c.tangent_n - c.tangent_gain * creep;

  Vector3d& bristle = bristle_m_[at.taxel];
  bristle += ahead_s_ * creep;
  const double longest = friction_ * normal_force / c.tangent_k;
  if (const double length = bristle.norm(); length > longest) bristle *= longest / length;
  bristle += (h - ahead_s_) * creep;
  touched_at_[at.taxel] = step_;

  force_n_[at.taxel] = normal_force;
  loaded_.push_back(at.taxel);
  force_on_object_n_ -= on_taxel;
  torque_on_object_nm_ -= at.place_m.cross(on_taxel);
  finger_force_n_[at.finger + 1] += normal_force;
  finger_torque_nm_[at.finger + 1] -= normal_force * at.normal.dot(at.with_flexion);
}

double ContactPatch::lever_m(int finger) const {
  const double force = finger_force_n_[finger + 1];
  return force > 0.0 ? finger_torque_nm_[finger + 1] / force : 0.0;
}

}  // namespace touchtrace::scene
