#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"
#include "pipeline/scene/simulate/data_sets.h"

namespace touchtrace::scene {
namespace {

constexpr int whole_frames = 149;  // 15 per second, each scanned in 30 ms, in a clip of 10 s

TEST(SceneDataSets, OnlyCompleteFramesCount) {
  SceneOptions scene;
  scene.clip_spread = 0.0;
  scene.parameters = parse_parameters({"glove-lost=0"});
  for (int clip = 0; clip < 6; ++clip) {
    const auto frames = simulate_clip(scene, clip, 12.3 * clip).glove.frames();
    EXPECT_GE(frames, static_cast<std::size_t>(whole_frames));
    EXPECT_LE(frames, static_cast<std::size_t>(whole_frames + 1));
  }
}

TEST(SceneDataSets, PlansHaveTheRequiredFrames) {
  const DataSet& paper = find_data_set("paper");
  std::map<std::string, double> frames, num_objects;
  for (const PlannedRecording& recording : plan_recordings(paper, {}, 1.0)) {
    double& found = frames[recording.file.parent_path().string()];
    ++num_objects[recording.file.parent_path().string()];
    for (int clip = 0; clip < clip_count(recording.scene); ++clip)
      found += std::floor((clip_span(recording.scene, clip).length_s - 0.03) * 15.0) * 0.98;
  }
  ASSERT_EQ(frames.size(), paper.parts.size());
  for (const DataSetPart& part : paper.parts) {
    const double found = frames.at(part.activity + "/" + part.name);
    EXPECT_GE(found, part.frames * (1 - 1e-9));
    // Clips are whole: each object may exceed its share by the longest clip, 12 s at 15 Hz.
    EXPECT_LE(found, part.frames + num_objects.at(part.activity + "/" + part.name) * 177.0);
  }
}

TEST(SceneDataSets, PlansAreCompatibleAndCoverAllActivities) {
  std::set<std::string> files, activities;
  for (const PlannedRecording& recording : plan_recordings(find_data_set("paper"), {}, 0.01)) {
    EXPECT_TRUE(files.insert(recording.file.string()).second) << recording.file;
    EXPECT_TRUE(find_activity(recording.scene.activity).accepts(recording.scene.object));
    activities.insert(recording.scene.activity);
  }
  const auto names = activity_names();
  EXPECT_EQ(activities, std::set<std::string>(names.begin(), names.end()));
  EXPECT_TRUE(files.contains("throw/seen/ball.h5"));
  EXPECT_FALSE(files.contains("throw/seen/hammer.h5"));
  EXPECT_THROW(find_data_set("papers"), Error);
}

}  // namespace
}  // namespace touchtrace::scene
