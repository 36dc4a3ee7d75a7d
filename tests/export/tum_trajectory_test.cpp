#include "pipeline/export/tum_trajectory.h"

#include <gtest/gtest.h>

#include <limits>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"

namespace touchtrace {
namespace {

Labels three_labels() {
  Labels labels;
  labels.time_s = {0.0, 0.25, 0.5};
  labels.hand.position_m = {0.1, -0.2, 1.5, 0.125, -0.2, 1.5, 0.15, -0.2, 1.5};
  labels.hand.quality = {quality_good, quality_follows_hand, quality_good};
  labels.object = labels.hand;
  labels.object.quality = {quality_lost, quality_good, quality_good};
  labels.object.position_m[8] = std::numeric_limits<double>::quiet_NaN();
  return labels;
}

TEST(TumTrajectory, WritesOneLinePerMeasuredLabel) {
  const ScratchFolder folder;
  write_tum_trajectories(folder.path() / "new", three_labels(), 1700000000.5, false);
  EXPECT_EQ(read_file(folder.path() / "new" / "hand.txt"),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1700000000.500000 0.1 -0.2 1.5 0 0 0 1\n"
            "1700000000.750000 0.125 -0.2 1.5 0 0 0 1\n"
            "1700000001.000000 0.15 -0.2 1.5 0 0 0 1\n");
  EXPECT_EQ(read_file(folder.path() / "new" / "object.txt"),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1700000000.750000 0.125 -0.2 1.5 0 0 0 1\n");
}

TEST(TumTrajectory, OverwritesOnlyOnRequest) {
  const ScratchFolder folder;
  write_tum_trajectories(folder.path(), three_labels(), 0.0, false);
  EXPECT_THROW(write_tum_trajectories(folder.path(), three_labels(), 0.0, false), Error);
  EXPECT_NO_THROW(write_tum_trajectories(folder.path(), three_labels(), 0.0, true));
}

}  // namespace
}  // namespace touchtrace
