#include "pipeline/scene/simulate/video.h"

#include "pipeline/scene/camera/backdrop.h"
#include "pipeline/scene/camera/board_views.h"
#include "pipeline/scene/camera/exposure.h"
#include "pipeline/scene/camera/visible.h"

namespace touchtrace::scene {
namespace {

constexpr int board_samples_per_axis = 4;

}  // namespace

Video::Video(Runtime& runtime, const RgbdCamera& camera, const CameraClock& clock,
             const SceneOptions& options, const BoardInfo& board)
    : camera_(camera),
      clock_(clock),
      options_(options),
      board_(board),
      board_poses_(board_poses(camera, board, options.board_views, options.seed)),
      renderer_(runtime, camera, options.seed) {}

std::vector<std::uint64_t> Video::append_frames(const ClipMotion& motion, int clip,
                                                Recording& recording) const {
  Clip& described = recording.clips.back();
  auto sequences = clock_.frames_between(described.start_s, described.end_s);
  for (const std::uint64_t sequence : sequences) {
    recording.camera_times.sequence.push_back(sequence);
    recording.camera_times.device_time_s.push_back(clock_.device_time_s(sequence));
    recording.camera_times.host_time_s.push_back(clock_.arrival_s(sequence));
  }
  if (sequences.empty()) return sequences;
  const SceneSample first = sample_at(motion, clock_.true_time_s(sequences.front()));
  described.hand_box = draw_box(hand_solids(first, hand_model(options_.parameters.hand)), camera_,
                                options_.seed, clip, "hand");
  described.object_box =
      draw_box(tracked_solids(options_.object, first), camera_, options_.seed, clip, "object");
  return sequences;
}

RgbdFrame Video::camera_frame(const ClipMotion& motion, std::uint64_t sequence) {
  const Exposure exposure =
      expose(motion, options_, clock_.true_time_s(sequence), camera_.exposure_s);
  return renderer_.render(exposure, "camera frame", sequence);
}

RgbdFrame Video::background(std::size_t index) {
  return renderer_.render(static_exposure(room_solids()), "background", index);
}

RgbdFrame Video::board_view(std::size_t index) {
  auto solids = room_solids();
  solids.push_back(board_solid(board_, camera_.color_from_world.inverse() * board_poses_[index]));
  return renderer_.render(static_exposure(solids), "board view", index, board_samples_per_axis);
}

}  // namespace touchtrace::scene
