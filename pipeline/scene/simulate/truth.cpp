#include "pipeline/scene/simulate/truth.h"

#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {
namespace {

void append(std::vector<double>& values, const Eigen::Vector3d& v) {
  values.insert(values.end(), v.begin(), v.end());
}

void append(Truth::Body& body, const RigidState& state, const Eigen::Isometry3d& color_from_world) {
  const Eigen::Quaterniond turn(color_from_world.linear()), q = turn * state.orientation;
  append(body.position_m, color_from_world * state.position_m);
  append(body.velocity_m_per_s, turn * state.velocity_m_per_s);
  body.orientation_wxyz.insert(body.orientation_wxyz.end(), {q.w(), q.x(), q.y(), q.z()});
}

nlohmann::json glove_clock_truth(const GloveClock& clock) {
  return {{"first_frame_s", clock.first_frame_s},
          {"rate_hz", clock.rate_hz},
          {"latency_s", clock.latency_s},
          {"jitter_s", clock.jitter_s},
          {"lost_share", clock.lost_share}};
}

}  // namespace

Truth start_truth(const SceneOptions& options, const RgbdCamera& camera, const CameraClock& clock) {
  Truth truth;
  truth.calibration = calibration_truth(camera);
  truth.clocks = {{"camera", clock_truth(clock)},
                  {"glove0", glove_clock_truth(glove_clock(options))}};
  return truth;
}

void append_truth(Truth& truth, const ClipMotion& motion, const ObjectSpec& object, int clip,
                  const Eigen::Isometry3d& color_from_world) {
  constexpr auto stride = static_cast<std::size_t>(sample_rate_hz / truth_rate_hz);
  for (std::size_t i = 0; i < motion.samples.size(); i += stride) {
    const SceneSample& sample = motion.samples[i];
    truth.time_s.push_back(sample.time_s);
    truth.clip.push_back(clip);
    append(truth.hand, sample.hand, color_from_world);
    append(truth.object, tracked_state(object, sample), color_from_world);
    append(truth.contact_force_n, color_from_world.linear() * sample.contact_force_n);
  }
  truth.events.insert(truth.events.end(), motion.events.begin(), motion.events.end());
}

}  // namespace touchtrace::scene
