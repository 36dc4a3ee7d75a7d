#include "pipeline/cli/update_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace touchtrace::cli {
namespace {

ModelSpec small_model() {
  return {.touch = true, .window_frames = 2, .rows = 6, .cols = 6, .embedding = 16, .hidden = 64};
}

/// Sums the shares; all numbers must be positive, except FLOPs of kernels that only move data.
double sum_of_shares(const nlohmann::json& rows) {
  double sum = 0.0;
  for (const auto& row : rows) {
    for (const char* key : {"seconds", "seconds_in_place", "share", "bytes_per_second"}) {
      const auto value = row.at(key).get<double>();
      EXPECT_TRUE(value > 0.0 && std::isfinite(value)) << key << " of " << row.dump();
    }
    const auto of_peak = row.at("share_of_peak").get<double>();
    EXPECT_TRUE(of_peak >= 0.0 && std::isfinite(of_peak)) << row.dump();
    sum += row.at("share").get<double>();
  }
  return sum;
}

TEST(UpdateTable, SharesSumToOne) {
  Runtime runtime(choose_device(""));
  const auto update = measure_update(runtime, small_model(), 2, 4);
  const auto json = nlohmann::json::parse(update_json(update).dump());
  EXPECT_EQ(json.at("launches").size(), update.launches.size());
  const double rounding = double(update.launches.size()) * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(sum_of_shares(json.at("launches")), 1.0, rounding);
  EXPECT_NEAR(sum_of_shares(json.at("purposes")), 1.0, rounding);
  for (const auto& [key, value] : json.at("update").items())
    EXPECT_TRUE(value.get<double>() > 0.0 && std::isfinite(value.get<double>())) << key;
}

TEST(UpdateTable, PlannedUpdateListsEveryLaunch) {
  Runtime runtime(choose_device(""));
  const auto plan = launches_of_update(runtime, small_model(), 2, 4);
  const auto rows = update_json(plan).at("launches");
  ASSERT_EQ(rows.size(), plan.size());
  for (std::size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(rows[i].at("kernel"), plan[i].kernel);
    EXPECT_EQ(rows[i].at("purpose"), name_of(plan[i].purpose));
  }
}

}  // namespace
}  // namespace touchtrace::cli
