#include <fmt/core.h>

#include "engine/base/provenance.h"
#include "pipeline/scene/camera/exposure.h"
#include "pipeline/scene/camera/renderer.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {
namespace {

constexpr double first_frame_s = 0.5, frame_interval_s = 0.05;
constexpr int frames = 100;

}  // namespace

void verify_rendering(const std::string& activity, const std::function<void(Figure)>& emit) {
  SceneOptions options;
  options.activity = activity;
  options.object = default_object(activity);
  options.image_width = 640, options.image_height = 480;
  options.clip_s = 2 * first_frame_s + frames * frame_interval_s;
  options.clip_spread = 0.0;
  const ClipMotion motion = simulate_clip(options, 0, 0.0);
  const RgbdCamera camera = make_camera(options);
  Runtime runtime(choose_device(""));
  Renderer renderer(runtime, camera, options.seed);
  const auto render = [&](int frame) {
    const double time_s = first_frame_s + frame * frame_interval_s;
    renderer.render(expose(motion, options, time_s, camera.exposure_s), "camera frame",
                    static_cast<std::uint64_t>(frame));
  };
  render(0);
  const Stopwatch stopwatch;
  for (int frame = 0; frame < frames; ++frame) render(frame);
  const auto what = fmt::format("{}: rendering, 640 x 480", activity);
  emit(at_least(what, frames / stopwatch.wall_seconds(), "frames/s", 200.0));
  emit(reported(what, 1e3 * stopwatch.cpu_seconds() / frames, "CPU ms per frame"));
}

}  // namespace touchtrace::scene
