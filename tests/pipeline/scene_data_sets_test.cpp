#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "pipeline/scene/base/assumptions.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"
#include "pipeline/scene/simulate/data_sets.h"

namespace touchtrace::scene {
namespace {

constexpr int whole_frames = 149;  // of 15 a second, each scanned in 30 ms, in a clip of 10 s

TEST(SceneDataSets, CountWholeFramesOnly) {
  SceneOptions scene;
  scene.clip_spread = 0.0;
  scene.parameters = assumed({"glove-lost=0"});
  for (int clip = 0; clip < 6; ++clip) {
    const auto frames = simulate_clip(scene, clip, 12.3 * clip).glove.frames();
    EXPECT_GE(frames, static_cast<std::size_t>(whole_frames));
    EXPECT_LE(frames, static_cast<std::size_t>(whole_frames + 1));
  }
}

TEST(SceneDataSets, HaveTheFramesAskedFor) {
  const DataSet& paper = find_data_set("paper");
  std::map<std::string, double> frames;
  for (const PlannedRecording& recording : recordings_of(paper, {}, 1.0)) {
    double& found = frames[recording.file.parent_path().string()];
    for (int clip = 0; clip < clip_count(recording.scene); ++clip)
      found += std::floor((clip_span(recording.scene, clip).length_s - 0.03) * 15.0) * 0.98;
  }
  ASSERT_EQ(frames.size(), paper.parts.size());
  for (const DataSetPart& part : paper.parts) {
    const double found = frames.at(part.activity + "/" + part.name);
    EXPECT_GE(found, part.frames * (1 - 1e-9));
    EXPECT_LE(found, part.frames * 1.02 + 177.0);
  }
}

TEST(SceneDataSets, AskOnlyForWhatCanBeDone) {
  std::set<std::string> files, activities;
  for (const PlannedRecording& recording : recordings_of(find_data_set("paper"), {}, 0.01)) {
    EXPECT_TRUE(files.insert(recording.file.string()).second) << recording.file;
    EXPECT_TRUE(find_activity(recording.scene.activity).takes(recording.scene.object));
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
