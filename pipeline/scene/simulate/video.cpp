#include "pipeline/scene/simulate/video.h"

#include "engine/base/interrupt.h"
#include "pipeline/scene/camera/backdrop.h"
#include "pipeline/scene/camera/board_views.h"
#include "pipeline/scene/camera/exposure.h"
#include "pipeline/scene/camera/visible.h"

namespace touchtrace::scene {
namespace {

constexpr int board_samples_per_axis = 4;

void append_stamps(CameraTimes& times, const CameraClock& clock, std::uint64_t sequence) {
  times.sequence.push_back(sequence);
  times.device_time_s.push_back(clock.device_time_s(sequence));
  times.host_time_s.push_back(clock.arrival_s(sequence));
}

}  // namespace

Video::Video(Runtime& runtime, const RgbdCamera& camera, const CameraClock& clock,
             const SceneOptions& options, RecordingWriter& writer)
    : camera_(camera),
      clock_(clock),
      options_(options),
      writer_(writer),
      renderer_(runtime, camera, options.seed) {}

void Video::store(RgbdFrame frame, Append append) {
  if (storing_.valid()) storing_.get();
  storing_ = std::async(std::launch::async,
                        [this, append, frame = std::move(frame)] { (writer_.*append)(frame); });
}

void Video::record_clip(const ClipMotion& motion, int clip, Recording& recording) {
  Clip& described = recording.clips.back();
  const auto sequences = clock_.frames_between(described.start_s, described.end_s);
  for (std::uint64_t sequence : sequences) {
    throw_if_interrupted();
    const Exposure exposure =
        expose(motion, options_, clock_.true_time_s(sequence), camera_.exposure_s);
    store(renderer_.render(exposure, "camera frame", sequence),
          &RecordingWriter::append_camera_frame);
    append_stamps(recording.camera_times, clock_, sequence);
  }
  if (sequences.empty()) return;
  const SceneSample first = sample_at(motion, clock_.true_time_s(sequences.front()));
  described.hand_box = draw_box(hand_solids(first, hand_model(options_.parameters.hand)), camera_,
                                options_.seed, clip, "hand");
  described.object_box =
      draw_box(tracked_solids(options_.object, first), camera_, options_.seed, clip, "object");
}

std::size_t Video::record_still_views(const BoardInfo& board) {
  for (int i = 0; i < background_frames; ++i)
    store(renderer_.render(static_exposure(room_solids()), "background",
                           static_cast<std::uint64_t>(i)),
          &RecordingWriter::append_background);
  const auto poses = board_poses(camera_, board, options_.board_views, options_.seed);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    throw_if_interrupted();
    auto solids = room_solids();
    solids.push_back(board_solid(board, camera_.color_from_world.inverse() * poses[i]));
    store(renderer_.render(static_exposure(solids), "board view", i, board_samples_per_axis),
          &RecordingWriter::append_board_view);
  }
  if (storing_.valid()) storing_.get();
  return poses.size();
}

}  // namespace touchtrace::scene
