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

constexpr double air_kg_per_m3 = 1.20;  // at 20 degrees
constexpr double max_object_acceleration_m_per_s2 = 300.0;
constexpr double touching_m = 1e-9;
constexpr int num_bisections = 40;

Vector3d acceleration(double drag, const Vector3d& v) {
  return -gravity_m_per_s2 * Vector3d::UnitZ() - drag * v.norm() * v;
}

/// State after `seconds` at constant velocity.
RigidState extrapolated(RigidState state, double seconds) {
  state.position_m += seconds * state.velocity_m_per_s;
  state.orientation =
      rotation_from_vector(seconds * state.angular_velocity_rad_per_s) * state.orientation;
  return state;
}

/// A free body with an impulse at `arm_m` from its centre of mass; world frame.
struct ImpactBody {
  double inverse_mass;
  Matrix3d inverse_inertia;
  Vector3d arm_m;

  Vector3d velocity_at_arm(const RigidState& state) const {
    return state.velocity_m_per_s + state.angular_velocity_rad_per_s.cross(arm_m);
  }
  /// Derivative of that velocity with respect to the impulse.
  Matrix3d compliance() const {
    const Matrix3d arm = cross_matrix(arm_m);
    return inverse_mass * Matrix3d::Identity() - arm * inverse_inertia * arm;
  }
  void apply(RigidState& state, const Vector3d& impulse_ns) const {
    state.velocity_m_per_s += inverse_mass * impulse_ns;
    state.angular_velocity_rad_per_s += inverse_inertia * arm_m.cross(impulse_ns);
  }
};

ImpactBody impact_body(const ObjectSpec& object, const RigidState& held, const Vector3d& point_m) {
  const Matrix3d turn = held.orientation.toRotationMatrix();
  return {1.0 / object.mass_kg, turn * object.inertia_kg_m2.inverse() * turn.transpose(),
          point_m - held.position_m};
}

/// A thin hollow sphere: 2/3 m r^2.
ImpactBody impact_body(const Ball& ball, const RigidState& state, const Vector3d& point_m) {
  const double inertia = 2.0 / 3.0 * ball.mass_kg * ball.radius_m * ball.radius_m;
  return {1.0 / ball.mass_kg, Matrix3d::Identity() / inertia, point_m - state.position_m};
}

/// Impulse of an impact at relative `velocity`: the normal velocity is reversed with `restitution`;
/// the tangential velocity becomes 0 (rolling) if friction suffices, otherwise the bodies slide.
Vector3d impulse_ns(const Matrix3d& compliance, const Vector3d& velocity, const Vector3d& normal,
                    double restitution, double friction) {
  const double approach = -normal.dot(velocity), separation = (1.0 + restitution) * approach;
  const Vector3d slip = velocity + approach * normal;
  const Vector3d rolling = compliance.llt().solve(separation * normal - slip);
  const double along = normal.dot(rolling);
  if ((rolling - along * normal).norm() <= friction * along) return rolling;
  const Vector3d sliding = normal - friction * slip.normalized();
  return separation / normal.dot(compliance * sliding) * sliding;
}

Vector3d in_body(const RigidState& body, const Vector3d& point_m) {
  return body.orientation.conjugate() * (point_m - body.position_m);
}

Distance surface_distance(const ObjectSpec& object, const RigidState& held,
                          const RigidState& ball) {
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
      (rotation_from_vector(h * state.angular_velocity_rad_per_s) * state.orientation).normalized();
}

double contact_free_time_s(const ObjectSpec& object, const RigidState& held, const RigidState& ball,
                           double max_s) {
  const auto is_clear = [&](double seconds) {
    RigidState there = ball;
    fly(*object.ball, there, seconds);
    return distance_m(object, in_body(extrapolated(held, seconds), there.position_m)) >
           object.ball->radius_m + 0.5 * max_object_acceleration_m_per_s2 * seconds * seconds;
  };
  if (is_clear(max_s)) return max_s;
  double free = 0.0, touching = max_s;
  for (int i = 0; i < num_bisections; ++i) {
    const double middle = 0.5 * (free + touching);
    (is_clear(middle) ? free : touching) = middle;
  }
  return free;
}

std::optional<Impact> bounce(const ObjectSpec& object, double restitution, RigidState& held,
                             RigidState& ball) {
  const Ball& b = *object.ball;
  const Distance d = surface_distance(object, held, ball);
  const double gap = d.value_m - b.radius_m;
  if (gap > touching_m) return std::nullopt;
  ball.position_m -= std::min(gap, 0.0) * d.normal;
  const Vector3d point = ball.position_m - b.radius_m * d.normal;
  const ImpactBody object_body = impact_body(object, held, point),
                   ball_body = impact_body(b, ball, point);
  const Vector3d velocity = ball_body.velocity_at_arm(ball) - object_body.velocity_at_arm(held);
  const double approach = -d.normal.dot(velocity);
  if (!(approach > 0.0)) return Impact{point, Vector3d::Zero(), 0.0};
  const Vector3d impulse = impulse_ns(object_body.compliance() + ball_body.compliance(), velocity,
                                      d.normal, restitution, b.friction);
  ball_body.apply(ball, impulse);
  object_body.apply(held, -impulse);
  return Impact{point, impulse, approach};
}

}  // namespace touchtrace::scene
