#include "calib/smooth/find_flights.h"

#include <gtest/gtest.h>

#include <utility>

#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

const Eigen::Vector3d gravity(0.0, 9.81, 0.0);

/// smooth() needs times that are correct to 60 ms.
TEST(FindFlights, FindsThrowsAtCommonRates) {
  const auto motion = synthetic_throw(30.0, 1);
  for (const double rate_hz : {20.0, 60.0, 240.0}) {
    const auto found = find_flights(measure(motion, rate_hz, 0.002, 1), gravity);
    ASSERT_EQ(found.size(), motion.flights.size()) << rate_hz;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].release_s, motion.flights[i].release_s, 0.06) << rate_hz;
      EXPECT_NEAR(found[i].landing_s, motion.flights[i].landing_s, 0.06) << rate_hz;
    }
  }
}

TEST(FindFlights, FindsNoneInAHandOrAtRest) {
  EXPECT_TRUE(find_flights(measure(synthetic_wave(20.0, 1), 60.0, 0.002, 1), gravity).empty());
  Track rest;
  for (int i = 0; i < 500; ++i)
    rest.push_back({0.02 * i, {0.1, 0.2, 0.3}, Eigen::Vector3d::Constant(0.002)});
  EXPECT_TRUE(find_flights(rest, gravity).empty());
}

/// Strokes along z that accelerate like gravity for moments, in noise in which a short window fits
/// any acceleration, and many places to search.
TEST(FindFlights, FindsNoneInFastStrokes) {
  const Eigen::Vector3d along_strokes(0.0, 0.0, -9.81);
  for (const double rate_hz : {20.0, 60.0})
    for (const double sigma_m : {0.002, 0.005}) {
      Track track = measure(synthetic_wave(120.0, 2), rate_hz, sigma_m, 2);
      for (auto& point : track) std::swap(point.position_m.x(), point.position_m.z());
      EXPECT_EQ(find_flights(track, along_strokes).size(), 0u) << rate_hz << " " << sigma_m;
    }
}

TEST(FindFlights, AcceptsAnyTimes) {
  EXPECT_TRUE(find_flights({}, gravity).empty());
  const TrackPoint point{1.0, {0.1, 0.2, 0.3}, Eigen::Vector3d::Constant(0.002)};
  EXPECT_TRUE(find_flights(Track(1, point), gravity).empty());
  EXPECT_TRUE(find_flights(Track(100000, point), gravity).empty());
  Track sparse(20, point);
  for (std::size_t i = 0; i < sparse.size(); ++i) sparse[i].time_s = 1e6 * static_cast<double>(i);
  EXPECT_TRUE(find_flights(sparse, gravity).empty());
}

}  // namespace
}  // namespace touchtrace
