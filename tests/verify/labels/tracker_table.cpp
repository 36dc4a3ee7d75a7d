#include "tests/verify/labels/tracker_table.h"

#include <fmt/core.h>

#include <array>

#include "pipeline/label/track/box_tracker.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/study/label_error.h"
#include "tests/verify/labels/rendered_recording.h"

namespace touchtrace::study {
namespace {

using Emit = std::function<void(Figure)>;

constexpr std::array activities{"wave", "throw", "pingpong"};
constexpr std::array widths{320, 640};

struct Trial {
  double bad_percent, position_mm, cpu_ms_per_frame, times_real_time;
};

Trial measure_tracker(const RenderedRecording& rendered, const std::string& tracker) {
  const Stopwatch stopwatch;
  const auto labels = rendered.label(tracker);
  const double wall_s = stopwatch.wall_seconds(), cpu_s = stopwatch.cpu_seconds();
  const auto error = compare_labels_with_truth(labels, rendered.truth()).object;
  const auto& recording = rendered.recording();
  const double frames = static_cast<double>(recording.camera_times.frames());
  return {100.0 * (error.lost_share + error.wrong_share), 1e3 * error.position_spread_m.norm(),
          1e3 * cpu_s / frames, frames / recording.camera.rate_hz / wall_s};
}

/// Speed of all of labelling on two cores, with the trackers' goals.
Figure speed_figure(const std::string& name, const std::string& tracker, double times) {
  const auto title = name + ": speed, all of labelling, in real time";
  return at_least(title, times, "x", tracker == "component" ? 10.0 : 1.5);
}

void measure_recording(const std::string& activity, int width, int height, Picture& picture,
                       const Emit& emit, Progress& progress) {
  const RenderedRecording rendered({activity, scene::default_object(activity), 1, width, height});
  Picture::Curve curve{fmt::format("{} {}x{}", activity, width, height), {}, {}};
  for (const auto& kind : label::tracker_kinds()) {
    const auto trial = measure_tracker(rendered, kind.name);
    progress.advance();
    const auto name = fmt::format("{}, {}", curve.name, kind.name);
    emit(reported(name + ": object lost or wrong", trial.bad_percent, "%"));
    emit(reported(name + ": object position RMS about its bias", trial.position_mm, "mm"));
    emit(reported(name + ": CPU time, all of labelling", trial.cpu_ms_per_frame, "ms/frame"));
    emit(speed_figure(name, kind.name, trial.times_real_time));
    curve.x.push_back(trial.cpu_ms_per_frame);
    curve.y.push_back(trial.position_mm);
  }
  picture.curves.push_back(std::move(curve));
}

}  // namespace

std::uint64_t tracker_trials() {
  return activities.size() * widths.size() * label::tracker_kinds().size();
}

void measure_trackers(const Emit& emit, Progress& progress) {
  Picture picture{"CPU time [ms/frame]", "object position RMS [mm]", true, false, {}};
  for (const char* activity : activities)
    for (const int width : widths)
      measure_recording(activity, width, 3 * width / 4, picture, emit, progress);
  auto table = reported("trackers compared", static_cast<double>(picture.curves.size()), "curves");
  table.picture = std::move(picture);
  emit(std::move(table));
}

}  // namespace touchtrace::study
