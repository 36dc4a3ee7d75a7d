#include "tests/verify/labels/rendered_recording.h"

#include <algorithm>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "engine/cl/runtime.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/scene/simulate/simulate.h"

namespace touchtrace::study {
namespace {

constexpr double half_a_minute = 0.5, cover_m = 0.5;
constexpr std::uint8_t cover_gray = 110;

void simulate(const RenderedScene& scene, const std::filesystem::path& output) {
  Runtime runtime(choose_device({}));
  scene::SceneOptions options;
  options.activity = scene.activity;
  options.object = scene.object;
  options.seed = scene.seed;
  options.minutes = half_a_minute;
  options.image_width = scene.width, options.image_height = scene.height;
  scene::simulate_recording(options, &runtime, output, true,
                            start_provenance("touchtrace/recording/2", "verify"));
}

void cover(RgbdFrame& frame, double depth_unit_m) {
  std::ranges::fill(frame.depth, static_cast<std::uint16_t>(std::lround(cover_m / depth_unit_m)));
  std::ranges::fill(frame.color, cover_gray);
}

}  // namespace

RenderedRecording::RenderedRecording(const RenderedScene& scene) {
  const auto path = folder_.path() / "recording.h5";
  simulate(scene, path);
  reader_ = std::make_unique<RecordingReader>(path);
  truth_ = read_truth(path);
  calibration_ = calibrate(board_views_from_recording(path));
}

Labels RenderedRecording::label(const std::string& tracker,
                                const std::vector<Cover>& covers) const {
  label::LabelOptions options;
  options.tracker = tracker;
  auto frames = label::frame_source(*reader_);
  const auto uncovered = frames.camera_frame;
  const auto time_s = label::align(recording()).camera_time_s;
  frames.camera_frame = [&](std::size_t i) {
    auto frame = uncovered(i);
    if (std::ranges::any_of(
            covers, [&](const Cover& c) { return time_s[i] >= c.from_s && time_s[i] < c.to_s; }))
      cover(frame, recording().camera.depth_unit_m);
    return frame;
  };
  return label::label_recording(recording(), frames, calibration_, options);
}

}  // namespace touchtrace::study
