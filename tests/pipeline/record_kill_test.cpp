#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "tests/verify/record/killed_recorder.h"

namespace touchtrace {
namespace {

TEST(RecordKill, NoAcknowledgedFrameIsLost) {
  const ScratchFolder folder;
  RandomStream random(1, "kills");
  std::uint64_t acknowledged = 0;
  for (int i = 0; i < 5; ++i) {
    const KilledRecorder killed = kill_recorder(folder.path(), random.uniform(0.2, 0.6));
    EXPECT_GE(killed.recovered_frames, killed.acknowledged_frames);
    EXPECT_TRUE(killed.is_complete);
    acknowledged += killed.acknowledged_frames;
  }
  EXPECT_GT(acknowledged, 20u);
}

}  // namespace
}  // namespace touchtrace
