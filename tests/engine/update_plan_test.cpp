#include "engine/train/update_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine/small_spec.h"

namespace touchtrace {
namespace {

std::size_t launches_of(const std::vector<PlannedLaunch>& plan, const std::string& kernel) {
  return static_cast<std::size_t>(std::ranges::count(plan, kernel, &PlannedLaunch::kernel));
}

TEST(UpdatePlan, ListsWhatIsQueuedAndNoPartThatIsLeftOut) {
  Runtime runtime(choose_device(""));
  const auto full = launches_of_update(runtime, testing::small_spec(true), 3, 4);
  const auto without_touch = launches_of_update(runtime, testing::small_spec(false), 3, 4);
  for (const auto* plan : {&full, &without_touch}) {
    for (const char* kernel : {"rollout", "rollout_backward", "state_loss", "adam"})
      EXPECT_EQ(launches_of(*plan, kernel), 1u) << kernel;
    for (const auto& launch : *plan) EXPECT_GT(launch.cost.bytes, 0.0) << launch.kernel;
  }
  EXPECT_EQ(launches_of(full, "tactile_window"), 1u);
  EXPECT_EQ(launches_of(full, "layer_norm"), 1u);
  EXPECT_EQ(launches_of(without_touch, "tactile_window"), 0u);
  EXPECT_EQ(launches_of(without_touch, "layer_norm"), 0u);
}

TEST(UpdatePlan, CountsTheOperationsOfARollout) {
  Runtime runtime(choose_device(""));
  const auto plan = launches_of_update(runtime, testing::small_spec(false), 3, 4);
  const auto rollout = std::ranges::find(plan, "rollout", &PlannedLaunch::kernel);
  ASSERT_NE(rollout, plan.end());
  EXPECT_EQ(rollout->cost.flops, 2.0 * 3 * 4 * 64 * (5 + 64 + 32));
}

}  // namespace
}  // namespace touchtrace
