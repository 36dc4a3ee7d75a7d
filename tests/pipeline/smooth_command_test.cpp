#include <cmath>

#include "tests/pipeline/smooth_command_fixture.h"

namespace touchtrace::smooth_command {
namespace {

/// Position and velocity of a sine. A velocity is wrong by 4 standard deviations in 1 of 16000
/// cases; they are correlated over some 10 samples, and the smoother estimates them to 20 %. The
/// filter knows at least the last measurement, whose standard deviation is 1 mm.
TEST_F(SmoothCommand, WritesPositionAndVelocityWithinTheirCovariance) {
  put(folder_ / "sine.csv", csv(sine(20.0, 1)));
  ASSERT_EQ(run({path("sine.csv"), "--sigma", "0.001", "-o", path("out")}), 0);
  auto columns = columns_of(folder_ / "out/sine.csv");
  EXPECT_EQ(columns.size(), 37u);
  const auto t = numbers(columns["time_s"]), x = numbers(columns["x_m"]),
             vx = numbers(columns["vx_m_per_s"]), var_x = numbers(columns["cov_x_x"]),
             var_vx = numbers(columns["cov_vx_vx"]), filtered = numbers(columns["causal_x_m"]);
  ASSERT_EQ(t.size(), 2001u);
  double squares = 0.0, smoothed_m2 = 0.0, filtered_m2 = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double error = vx[i] - amplitude_m * rad_per_s * std::cos(rad_per_s * t[i]);
    EXPECT_LT(std::abs(error), 5.0 * std::sqrt(var_vx[i])) << t[i];
    const double truth_m = amplitude_m * std::sin(rad_per_s * t[i]);
    EXPECT_LT(std::abs(x[i] - truth_m), 5.0 * std::sqrt(var_x[i]));
    smoothed_m2 += std::pow(x[i] - truth_m, 2), filtered_m2 += std::pow(filtered[i] - truth_m, 2);
    squares += error * error / var_vx[i];
  }
  EXPECT_GT(squares / 2001.0, 0.4);
  EXPECT_LT(squares / 2001.0, 1.6);
  EXPECT_LT(std::sqrt(var_vx[1000]), 0.05 * amplitude_m * rad_per_s);
  EXPECT_LT(std::sqrt(filtered_m2 / 2001.0), 0.001);
  EXPECT_GT(filtered_m2, smoothed_m2);
}

TEST_F(SmoothCommand, SummarisesTracksThatShareTheirNoise) {
  fs::create_directories(folder_ / "second");
  put(folder_ / "hand.csv", csv(sine(5.0, 1)) + "9,,,\n");
  put(folder_ / "second/hand.csv", csv(sine(8.0, 2)));
  ::testing::internal::CaptureStdout();
  const int code = run({path("hand.csv"), path("second/hand.csv"), "-o", path("out"), "--json"});
  const json printed = json::parse(::testing::internal::GetCapturedStdout());
  ASSERT_EQ(code, 0);
  EXPECT_EQ(printed, summary());
  const auto& tracks = printed["tracks"];
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0]["name"], "hand");
  EXPECT_EQ(tracks[1]["name"], "hand-2");
  EXPECT_EQ(tracks[0]["skipped_rows"], 1);
  for (const auto& track : tracks) {
    EXPECT_EQ(track["status"], "converged");
    EXPECT_EQ(track["sigma_source"], "data");
    EXPECT_TRUE(fs::exists(track["output"].get<std::string>()));
    for (const auto& sigma_m : track["sigma_m"]) EXPECT_NEAR(sigma_m.get<double>(), 1e-3, 3e-4);
    EXPECT_NEAR(track["residual_rms"].get<double>(), 1.0, 0.3);
  }
  EXPECT_NEAR(printed["noise"]["measurement_scale"].get<double>(), 1.0, 0.3);
  EXPECT_EQ(printed["provenance"]["inputs"].size(), 2u);
  EXPECT_GT(printed["provenance"]["cpu_seconds"].get<double>(), 0.0);
}

TEST_F(SmoothCommand, PrintsATable) {
  put(folder_ / "hand.csv", csv(sine(5.0, 1)));
  ::testing::internal::CaptureStdout();
  const int code = run({path("hand.csv"), "-o", path("out")});
  const auto table = ::testing::internal::GetCapturedStdout();
  ASSERT_EQ(code, 0);
  for (const char* part : {"hand", "501", "5.0", "mm (estimated from the data)", "out/hand.csv"})
    EXPECT_NE(table.find(part), std::string::npos) << part << "\n" << table;
}

TEST_F(SmoothCommand, RateGivesAnEvenGrid) {
  const auto track = sine(5.0, 1);
  put(folder_ / "a.csv", csv(track));
  ASSERT_EQ(run({path("a.csv"), "--rate", "40", "-o", path("out")}), 0);
  auto columns = columns_of(folder_ / "out/a.csv");
  const auto t = numbers(columns["time_s"]), vx = numbers(columns["vx_m_per_s"]),
             var_vx = numbers(columns["cov_vx_vx"]);
  ASSERT_EQ(t.size(), 201u);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(t[i], 0.025 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(vx[i], amplitude_m * rad_per_s * std::cos(rad_per_s * t[i]),
                5.0 * std::sqrt(var_vx[i]));
  }
  put(folder_ / "gap.csv", "0,1,1,1\n1,1,1,1\n100000000,1,1,1\n");
  EXPECT_EQ(run({path("gap.csv"), "--sigma", "1", "--rate", "100", "-o", path("gap")}), 2);
}

TEST_F(SmoothCommand, NanosecondTimesSurvive) {
  std::string text = "timestamp_ns,x_mm,y_mm,z_mm\n";
  RandomStream random(3, "times");
  std::vector<std::string> expected;
  for (int i = 0; i < 40; ++i) {
    const int ns = 123456789 + 20000001 * i;
    text += fmt::format("1700000000{:09},{},{},{}\n", ns, random.normal(), random.normal(),
                        random.normal());
    expected.push_back(fmt::format("1700000000.{:09}", ns));
  }
  put(folder_ / "a.csv", text);
  ASSERT_EQ(run({path("a.csv"), "-o", path("out")}), 0);
  const auto times = columns_of(folder_ / "out/a.csv")["time_s"];
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_EQ(times[i], expected[i].substr(0, expected[i].find_last_not_of('0') + 1));
  EXPECT_EQ(summary()["tracks"][0]["start_s"], "1700000000.123456789");
}

/// Times of flights of a ball that is thrown along -y, found or given with an error of 30 ms.
TEST_F(SmoothCommand, EstimatesFlights) {
  const auto motion = synthetic_throw(20.0, 1);
  put(folder_ / "ball.csv", csv(measure(motion, 60.0, 0.002, 1)));
  std::string guess = "release_s,landing_s\n";
  for (const auto& flight : motion.flights)
    guess += fmt::format("{},{}\n", flight.release_s + 0.03, flight.landing_s - 0.03);
  put(folder_ / "guess.csv", guess);
  for (const auto& flights : {std::string("find"), path("guess.csv")}) {
    ASSERT_EQ(run({"--gravity", "0", "9.81", "0", path("ball.csv"), "--sigma", "0.002", "--flights",
                   flights, "-o", path("out"), "--overwrite"}),
              0);
    auto columns = columns_of(folder_ / "out/ball.flights.csv");
    const auto release_s = numbers(columns["release_s"]), landing_s = numbers(columns["landing_s"]),
               sigma_s = numbers(columns["landing_sigma_s"]);
    ASSERT_EQ(release_s.size(), motion.flights.size());
    EXPECT_EQ(summary()["tracks"][0]["flights"], motion.flights.size());
    for (std::size_t i = 0; i < release_s.size(); ++i) {
      EXPECT_NEAR(release_s[i], motion.flights[i].release_s, 0.03);
      EXPECT_NEAR(landing_s[i], motion.flights[i].landing_s, 0.02);
      EXPECT_GT(sigma_s[i], 0.0);
      EXPECT_LT(sigma_s[i], 0.02);
    }
  }
  ASSERT_EQ(run({path("ball.csv"), "-o", path("out"), "--overwrite"}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/ball.flights.csv"));  // of the previous run
}

/// Knots of the process noise throughout a year would take gigabytes.
TEST_F(SmoothCommand, AGapOfAYearIsNamedAndCostsNothing) {
  Track track = sine(2.0, 4);
  for (auto point : sine(2.0, 5)) point.time_s += 3.2e7, track.push_back(point);
  put(folder_ / "gap.csv", csv(track));
  ::testing::internal::CaptureStderr();
  ASSERT_EQ(run({path("gap.csv"), "--sigma", "0.001", "-o", path("out")}), 0);
  const auto text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("a gap of 3.2e+07 s"), std::string::npos) << text;
  EXPECT_NEAR(summary()["tracks"][0]["residual_rms"].get<double>(), 1.0, 0.3);
}

TEST_F(SmoothCommand, ABodyAtRestNeedsNoNoise) {
  Track track = sine(2.0, 4);
  for (auto& point : track) point.position_m.setConstant(0.25);
  put(folder_ / "rest.csv", csv(track));
  ASSERT_EQ(run({path("rest.csv"), "--sigma", "0.001", "-o", path("out")}), 0);
  auto columns = columns_of(folder_ / "out/rest.csv");
  for (const double v : numbers(columns["vx_m_per_s"])) EXPECT_NEAR(v, 0.0, 1e-9);
}

TEST_F(SmoothCommand, CountsMeasurementsThatItDoesNotBelieve) {
  Track track = sine(4.0, 4);
  track[150].position_m.x() += 0.5;
  put(folder_ / "a.csv", csv(track));
  ASSERT_EQ(run({path("a.csv"), "--sigma", "0.001", "-o", path("out")}), 0);
  EXPECT_EQ(summary()["tracks"][0]["outliers"], 1);
  EXPECT_TRUE(summary()["tracks"][0]["flights_output"].is_null());
}

}  // namespace
}  // namespace touchtrace::smooth_command
