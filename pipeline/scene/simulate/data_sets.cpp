#include "pipeline/scene/simulate/data_sets.h"

#include <cmath>

#include "engine/base/named.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"

namespace touchtrace::scene {
namespace {

std::vector<ObjectSpec> part_objects(const DataSetPart& part) {
  if (part.objects.empty()) return {default_object(part.activity)};
  std::vector<ObjectSpec> found;
  for (const ObjectSpec& object : objects())
    if (role_name(object.role) == part.objects && find_activity(part.activity).accepts(object))
      found.push_back(object);
  return found;
}

/// Expected number of glove frames of a clip, at least 1.
double expected_frames(const ClipSpan& span, const GloveParameters& glove) {
  const double whole = std::floor((span.length_s - glove.scan_s) * GloveInfo{}.rate_hz);
  return std::max(1.0, whole * (1.0 - glove.lost_fraction));
}

int clips_for(double frames, const SceneOptions& scene) {
  int clips = 0;
  do frames -= expected_frames(clip_span(scene, clips++), scene.parameters.glove);
  while (frames > 0.0);
  return clips;
}

}  // namespace

const std::vector<DataSet>& data_sets() {
  static const std::vector<DataSet> table{
      {"paper",
       "activities, objects and frame counts of the paper's table",
       {{"wave", "seen", "seen", 208e3},
        {"wave", "unseen", "unseen", 58e3},
        {"throw", "seen", "seen", 230e3},
        {"throw", "unseen", "unseen", 61e3},
        {"pingpong", "train", "", 15e3},
        {"pingpong", "test", "", 3e3, 1},
        {"balance", "train", "", 15e3},
        {"balance", "test", "", 3e3, 1}}},
  };
  return table;
}

const DataSet& find_data_set(const std::string& name) {
  return find_named(data_sets(), "data set", name);
}

std::vector<PlannedRecording> plan_recordings(const DataSet& data_set, const SceneOptions& scene,
                                              double share) {
  std::vector<PlannedRecording> planned;
  for (const DataSetPart& part : data_set.parts) {
    const auto held = part_objects(part);
    for (const ObjectSpec& object : held) {
      PlannedRecording& recording = planned.emplace_back(PlannedRecording{scene, {}});
      recording.scene.activity = part.activity;
      recording.scene.object = object;
      recording.scene.seed += static_cast<std::uint64_t>(part.session);
      const double frames = share * part.frames / static_cast<double>(held.size());
      recording.scene.minutes = clips_for(frames, recording.scene) * scene.clip_s / 60.0;
      recording.file = std::filesystem::path(part.activity) / part.name / (object.name + ".h5");
    }
  }
  return planned;
}

}  // namespace touchtrace::scene
