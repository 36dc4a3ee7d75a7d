#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

RigidState tracked_state(const ObjectSpec& object, const SceneSample& sample) {
  if (sample.ball) return *sample.ball;
  RigidState state = sample.object;
  const Eigen::Vector3d offset = state.orientation * object.tracked_m;
  state.position_m += offset;
  state.velocity_m_per_s += state.angular_velocity_rad_per_s.cross(offset);
  return state;
}

}  // namespace touchtrace::scene
