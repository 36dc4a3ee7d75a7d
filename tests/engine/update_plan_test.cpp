#include "engine/train/update_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/small_spec.h"

namespace touchtrace {
namespace {

std::size_t launches_of(const std::vector<PlannedLaunch>& plan, const std::string& kernel) {
  return static_cast<std::size_t>(std::ranges::count(plan, kernel, &PlannedLaunch::kernel));
}

/// The default device with the kernels for CPUs, whose names these tests know, even on a GPU.
Runtime cpu_kernels() { return Runtime(choose_device(""), Accuracy::fast, KernelVariant::cpu); }

TEST(UpdatePlan, ListsEnqueuedLaunchesOnly) {
  Runtime runtime = cpu_kernels();
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

TEST(UpdatePlan, MeasuresEveryLaunchInOrder) {
  Runtime runtime(choose_device(""));
  for (const auto& spec :
       {testing::small_spec(ObjectEncoder::joint), testing::small_spec(ObjectEncoder::frozen),
        testing::small_spec(false)}) {
    const auto plan = launches_of_update(runtime, spec, 3, 4);
    const auto measured = measure_update(runtime, spec, 3, 4);
    ASSERT_EQ(measured.launches.size(), plan.size());
    for (std::size_t i = 0; i < plan.size(); ++i) {
      const auto& [launch, seconds, seconds_in_place] = measured.launches[i];
      EXPECT_EQ(launch.kernel, plan[i].kernel);
      EXPECT_EQ(launch.cost.flops, plan[i].cost.flops) << launch.kernel;
      EXPECT_TRUE(seconds > 0.0 && seconds < 1.0) << launch.kernel << " " << seconds;
      EXPECT_TRUE(seconds_in_place > 0.0 && seconds_in_place < 1.0)
          << launch.kernel << " " << seconds_in_place;
    }
    EXPECT_TRUE(measured.peak_flops > 1e6 && std::isfinite(measured.peak_flops));
    EXPECT_TRUE(measured.wall_seconds > 0.0 && measured.wall_seconds < 10.0);
    EXPECT_TRUE(measured.cpu_seconds > 0.0 && measured.cpu_seconds < 10.0);
  }
}

TEST(UpdatePlan, KnowsThePurposeOfEachProduct) {
  Runtime runtime = cpu_kernels();
  const auto plan = launches_of_update(runtime, testing::small_spec(true), 3, 4);
  const auto products_for = [&](Purpose purpose) {
    return std::ranges::count_if(plan, [&](const PlannedLaunch& launch) {
      return launch.kernel == "gemm" && launch.purpose == purpose;
    });
  };
  // The dense layer of the encoder, and the columns for the embedding in the dynamics' first layer.
  EXPECT_EQ(products_for(Purpose::forward), 2);
  EXPECT_EQ(products_for(Purpose::data_gradient), 2);
  // These two, the columns for the state, the second layer, and the two halves of the output layer.
  EXPECT_EQ(products_for(Purpose::weight_gradient), 6);
}

TEST(UpdatePlan, SkipsOutputsWithoutLiveTaxel) {
  Runtime runtime = cpu_kernels();
  const auto spec = testing::small_spec(true);
  LiveTaxels live(9 * 6, 1);
  std::fill(live.begin() + 5 * 6, live.end(), 0);
  const auto flops_of = [&](const char* kernel, const LiveTaxels& known) {
    double sum = 0.0;
    for (const auto& launch : launches_of_update(runtime, spec, 3, 4, known))
      if (launch.kernel == kernel) sum += launch.cost.flops;
    return sum;
  };
  // Of five output rows the first three read rows 0 to 4; 6 of 15 outputs read none of them.
  for (const char* kernel : {"conv2d_forward", "conv2d_backward_weights"}) {
    const double all = flops_of(kernel, {}), per_output = 2.0 * 9 * 12 * 3 * 32;
    EXPECT_EQ(all - flops_of(kernel, live), 6 * per_output) << kernel;
    EXPECT_EQ(all - flops_of(kernel, LiveTaxels(9 * 6, 0)), 15 * per_output) << kernel;
  }
}

TEST(UpdatePlan, HasOneLaunchPerGruPass) {
  Runtime runtime = cpu_kernels();
  const auto plan = launches_of_update(runtime, testing::with_gru(testing::small_spec(true)), 3, 4);
  for (const char* kernel : {"gru_rollout", "gru_rollout_backward"})
    EXPECT_EQ(launches_of(plan, kernel), 1u) << kernel;
  for (const char* kernel : {"rollout", "rollout_backward"})
    EXPECT_EQ(launches_of(plan, kernel), 0u) << kernel;
}

TEST(UpdatePlan, CountsRolloutOperations) {
  Runtime runtime = cpu_kernels();
  const auto plan = launches_of_update(runtime, testing::small_spec(false), 3, 4);
  const auto rollout = std::ranges::find(plan, "rollout", &PlannedLaunch::kernel);
  ASSERT_NE(rollout, plan.end());
  EXPECT_EQ(rollout->cost.flops, 2.0 * 3 * 4 * 64 * (5 + 64 + 32));
}

}  // namespace
}  // namespace touchtrace
