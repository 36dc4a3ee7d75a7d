#include "pipeline/scene/camera/visible.h"

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const Vector3d sleeve_color(0.35, 0.12, 0.10);
// Elbow, at the side of the person, who stands at the origin.
const Vector3d elbow_m(-0.22, -0.02, 1.02);
const Vector3d wrist_in_hand_m(-0.075, 0.0, -0.014);

Isometry3d pose_of(const RigidState& body) {
  Isometry3d world_from_body = Isometry3d::Identity();
  world_from_body.linear() = body.orientation.toRotationMatrix();
  world_from_body.translation() = body.position_m;
  return world_from_body;
}

/// Adds the palm and the ridges around its hollow.
void add_palm(std::vector<Solid>& solids, const Isometry3d& world_from_hand) {
  Solid palm{ShapeKind::box, {0.047, 0.043, 0.012}, Isometry3d::Identity(), glove_color()};
  palm.body_from_shape.translation().z() = -0.012;
  palm.body_from_shape = world_from_hand * palm.body_from_shape;
  solids.push_back(palm);
  constexpr double x = 0.038, y = 0.036, front = -0.001, heel = 0.008, radius = 0.010;
  const std::array<Vector3d, 4> corners{Vector3d(x, -y, front), Vector3d(x, y, front),
                                        Vector3d(-x, y, heel), Vector3d(-x, -y, heel)};
  for (int i = 0; i < 4; ++i)
    solids.push_back(capsule_between(world_from_hand * corners[i],
                                     world_from_hand * corners[(i + 1) % 4], radius,
                                     glove_color()));
}

void add_finger(std::vector<Solid>& solids, const Isometry3d& world_from_hand, const Finger& finger,
                double flexion_rad) {
  const FingerPose pose = pose_finger(finger, flexion_rad);
  for (int link = 0; link < finger.links; ++link) {
    const Vector3d end =
        pose.joint_m[link] + finger.length_m[link] * pose.hand_from_link[link].col(0);
    solids.push_back(capsule_between(world_from_hand * pose.joint_m[link], world_from_hand * end,
                                     finger.radius_m, glove_color()));
  }
}

}  // namespace

Vector3d glove_color() { return {0.07, 0.09, 0.14}; }

std::vector<Solid> hand_solids(const SceneSample& sample, const HandModel& hand) {
  const Isometry3d world_from_hand = pose_of(sample.hand);
  std::vector<Solid> solids;
  add_palm(solids, world_from_hand);
  for (int i = 0; i < num_fingers; ++i)
    add_finger(solids, world_from_hand, hand.fingers[i], sample.flexion_rad[i]);
  const Vector3d heel = world_from_hand * Vector3d(-0.040, 0.0, -0.012);
  solids.push_back(capsule_between(heel, world_from_hand * wrist_in_hand_m, 0.026, glove_color()));
  return solids;
}

Solid forearm_solid(const SceneSample& sample) {
  return capsule_between(pose_of(sample.hand) * wrist_in_hand_m, elbow_m, 0.035, sleeve_color);
}

std::vector<Solid> object_solids(const ObjectSpec& object, const SceneSample& sample) {
  std::vector<Solid> solids = object.solids;
  const Isometry3d world_from_object = pose_of(sample.object);
  for (Solid& solid : solids) solid.body_from_shape = world_from_object * solid.body_from_shape;
  return solids;
}

std::vector<Solid> ball_solids(const ObjectSpec& object, const SceneSample& sample) {
  if (!sample.ball) return {};
  const Ball& ball = *object.ball;
  return {{ShapeKind::sphere, {ball.radius_m, 0.0, 0.0}, pose_of(*sample.ball), ball.color}};
}

std::vector<Solid> tracked_solids(const ObjectSpec& object, const SceneSample& sample) {
  if (sample.ball) return ball_solids(object, sample);
  std::vector<Solid> solids = object_solids(object, sample);
  const Vector3d point = tracked_state(object, sample).position_m;
  if (!object.tracked_m.isZero(0.0))
    std::erase_if(solids, [&](const Solid& solid) { return distance(solid, point).value_m > 0.0; });
  return solids;
}

}  // namespace touchtrace::scene
