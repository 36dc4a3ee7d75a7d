#include "pipeline/scene/physics/ball.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "pipeline/scene/base/rotation.h"
#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double air_kg_per_m3 = 1.20;         // at 20 degrees
constexpr double unforeseen_m_per_s2 = 300.0;  // of a held object
constexpr double touching_m = 1e-9;
constexpr int halvings = 40;

Vector3d acceleration(double drag, const Vector3d& v) {
  return -gravity_m_per_s2 * Vector3d::UnitZ() - drag * v.norm() * v;
}

/// Where an object gets with the velocity that it has.
RigidState coasted(RigidState state, double seconds) {
  state.position_m += seconds * state.velocity_m_per_s;
  state.orientation = rotation_by(seconds * state.angular_velocity_rad_per_s) * state.orientation;
  return state;
}

/// [v]x: its product with a vector is the cross product.
Matrix3d cross_product(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// A body that an impulse at `arm_m` from its centre of mass sets in motion.
struct Struck {
  double inverse_mass;
  Matrix3d inverse_inertia;  ///< world
  Vector3d arm_m;

  Vector3d velocity_at_arm(const RigidState& state) const {
    return state.velocity_m_per_s + state.angular_velocity_rad_per_s.cross(arm_m);
  }
  /// Change of that velocity by an impulse.
  Matrix3d compliance() const {
    const Matrix3d arm = cross_product(arm_m);
    return inverse_mass * Matrix3d::Identity() - arm * inverse_inertia * arm;
  }
  void strike(RigidState& state, const Vector3d& impulse_ns) const {
    state.velocity_m_per_s += inverse_mass * impulse_ns;
    state.angular_velocity_rad_per_s += inverse_inertia * arm_m.cross(impulse_ns);
  }
};

Struck struck(const ObjectSpec& object, const RigidState& held, const Vector3d& place_m) {
  const Matrix3d turn = held.orientation.toRotationMatrix();
  return {1.0 / object.mass_kg, turn * object.inertia_kg_m2.inverse() * turn.transpose(),
          place_m - held.position_m};
}

/// A thin hollow sphere: 2/3 m r^2.
Struck struck(const Ball& ball, const RigidState& state, const Vector3d& place_m) {
  const double inertia = 2.0 / 3.0 * ball.mass_kg * ball.radius_m * ball.radius_m;
  return {1.0 / ball.mass_kg, Matrix3d::Identity() / inertia, place_m - state.position_m};
}

/// The impulse after which surfaces that met with `velocity` part along the normal as restitution
/// says, and roll on each other if friction is enough for that, otherwise still slide.
Vector3d impulse_ns(const Matrix3d& compliance, const Vector3d& velocity, const Vector3d& normal,
                    double restitution, double friction) {
  const double approach = -normal.dot(velocity), parting = (1.0 + restitution) * approach;
  const Vector3d slip = velocity + approach * normal;
  const Vector3d rolling = compliance.llt().solve(parting * normal - slip);
  const double along = normal.dot(rolling);
  if ((rolling - along * normal).norm() <= friction * along) return rolling;
  const Vector3d sliding = normal - friction * slip.normalized();
  return parting / normal.dot(compliance * sliding) * sliding;
}

Vector3d in_body(const RigidState& body, const Vector3d& point_m) {
  return body.orientation.conjugate() * (point_m - body.position_m);
}

Distance from_surface(const ObjectSpec& object, const RigidState& held, const RigidState& ball) {
  Distance d = distance(object, in_body(held, ball.position_m));
  d.normal = held.orientation * d.normal;
  return d;
}

}  // namespace

double drag_per_m(const Ball& ball) {
  return 0.5 * air_kg_per_m3 * ball.drag_coefficient * std::numbers::pi * ball.radius_m *
         ball.radius_m / ball.mass_kg;
}

void fly(const Ball& ball, RigidState& state, double h) {
  const double drag = drag_per_m(ball);
  const Vector3d v1 = state.velocity_m_per_s, a1 = acceleration(drag, v1);
  const Vector3d v2 = v1 + 0.5 * h * a1, a2 = acceleration(drag, v2);
  const Vector3d v3 = v1 + 0.5 * h * a2, a3 = acceleration(drag, v3);
  const Vector3d v4 = v1 + h * a3, a4 = acceleration(drag, v4);
  state.position_m += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
  state.velocity_m_per_s += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  state.orientation =
      (rotation_by(h * state.angular_velocity_rad_per_s) * state.orientation).normalized();
}

double free_time_s(const ObjectSpec& object, const RigidState& held, const RigidState& ball,
                   double most_s) {
  const auto clear = [&](double seconds) {
    RigidState there = ball;
    fly(*object.ball, there, seconds);
    return distance_m(object, in_body(coasted(held, seconds), there.position_m)) >
           object.ball->radius_m + 0.5 * unforeseen_m_per_s2 * seconds * seconds;
  };
  if (clear(most_s)) return most_s;
  double free = 0.0, touching = most_s;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (free + touching);
    (clear(middle) ? free : touching) = middle;
  }
  return free;
}

std::optional<Impact> bounce(const ObjectSpec& object, double restitution, RigidState& held,
                             RigidState& ball) {
  const Ball& b = *object.ball;
  const Distance d = from_surface(object, held, ball);
  const double gap = d.value_m - b.radius_m;
  if (gap > touching_m) return std::nullopt;
  ball.position_m -= std::min(gap, 0.0) * d.normal;
  const Vector3d place = ball.position_m - b.radius_m * d.normal;
  const Struck object_body = struck(object, held, place), ball_body = struck(b, ball, place);
  const Vector3d velocity = ball_body.velocity_at_arm(ball) - object_body.velocity_at_arm(held);
  const double approach = -d.normal.dot(velocity);
  if (!(approach > 0.0)) return Impact{place, Vector3d::Zero(), 0.0};
  const Vector3d impulse = impulse_ns(object_body.compliance() + ball_body.compliance(), velocity,
                                      d.normal, restitution, b.friction);
  ball_body.strike(ball, impulse);
  object_body.strike(held, -impulse);
  return Impact{place, impulse, approach};
}

}  // namespace touchtrace::scene
