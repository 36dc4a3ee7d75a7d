#include <cmath>

#include "tests/pipeline/smooth_command_fixture.h"

namespace touchtrace::smooth_command {
namespace {

TEST_F(SmoothCommand, WarnsOfTimesThatAreHardlySeconds) {
  const auto warnings = [&](double factor, int repeats) {
    std::string text = "time_s,x_m,y_m,z_m\n";
    for (const auto& point : sine(1.0, 4))
      for (int i = 0; i < repeats; ++i)
        text += fmt::format("{},{},{},{}\n", factor * point.time_s, point.position_m.x(),
                            point.position_m.y(), point.position_m.z());
    put(folder_ / "a.csv", text);
    ::testing::internal::CaptureStderr();
    run({path("a.csv"), "--sigma", "0.001", "-o", path("out"), "--overwrite"});
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings(1.0, 1), "");
  EXPECT_NE(warnings(1000.0, 1).find("samples are 10 s apart"), std::string::npos);
  EXPECT_NE(warnings(1.0, 2).find("101 of 202 samples have the time"), std::string::npos);
}

TEST_F(SmoothCommand, WarnsOfImplausibleInputs) {
  const auto warnings = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", path("out"), "--overwrite"});
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run(arguments), 0);
    return ::testing::internal::GetCapturedStderr();
  };
  const std::string no_warning, sigma = "times their stated", units = "x_mm, y_mm, z_mm";
  auto track = sine(5.0, 1);
  put(folder_ / "metres.csv", csv(track));
  EXPECT_EQ(warnings({path("metres.csv"), "--sigma", "0.001"}), no_warning);
  EXPECT_EQ(warnings({path("metres.csv"), "--sigma", "0.004"}), no_warning);
  EXPECT_NE(warnings({path("metres.csv"), "--sigma", "1"}).find(sigma), std::string::npos);
  for (std::size_t i = 101; i < 120; ++i) track[i].position_m = track[100].position_m;
  put(folder_ / "stuck.csv", csv(track));
  EXPECT_NE(warnings({path("stuck.csv")}).find("19 of 501 positions repeat"), std::string::npos);
  track = sine(5.0, 1);
  for (auto& point : track) point.position_m *= 1000.0;
  put(folder_ / "millimetres.csv", csv(track));
  EXPECT_NE(warnings({path("millimetres.csv")}).find(units), std::string::npos);
  track = sine(5.0, 1);  // too slow to be noticed by its speed
  for (auto& point : track)
    point.position_m = 30.0 * point.position_m + Eigen::Vector3d(0.0, 0.0, 800.0);
  put(folder_ / "far.csv", csv(track));
  EXPECT_NE(warnings({path("far.csv")}).find("m from the origin"), std::string::npos);
}

TEST_F(SmoothCommand, SkipsPositionsThatAreWrittenSeveralTimes) {
  auto track = sine(5.0, 1);
  put(folder_ / "once.csv", csv(track));
  for (std::size_t i = 0; i < track.size(); ++i) track[i].position_m = track[i - i % 3].position_m;
  put(folder_ / "thrice.csv", csv(track));
  const auto nees = [&](const char* name) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({path(name), "-o", path("out"), "--overwrite"}), 0);
    const bool warned = ::testing::internal::GetCapturedStderr().find(
                            "334 of 501 positions repeat") != std::string::npos;
    EXPECT_EQ(warned, std::string(name) == "thrice.csv");
    auto columns = columns_of(folder_ / "out" / fs::path(name));
    const auto time = numbers(columns["time_s"]), x = numbers(columns["x_m"]),
               variance = numbers(columns["cov_x_x"]);
    EXPECT_EQ(time.size(), warned ? 167u : 501u);
    double sum = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i)
      sum += std::pow(x[i] - amplitude_m * std::sin(rad_per_s * time[i]), 2) / variance[i];
    return sum / static_cast<double>(time.size());
  };
  // 1 if the covariance is right; with the repeats it is over 10
  EXPECT_LT(nees("once.csv"), 2.0);
  EXPECT_LT(nees("thrice.csv"), 2.0);
}

TEST_F(SmoothCommand, WarnsOfWrongGravity) {
  put(folder_ / "ball.csv", csv(measure(synthetic_throw(20.0, 1), 60.0, 0.002, 1)));
  const auto warnings = [&](const char* x, const char* y, const char* z) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({"--gravity", x, y, z, path("ball.csv"), "--sigma", "0.002", "--flights", "find",
                   "-o", path("out"), "--overwrite"}),
              0);
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings("0", "9.81", "0"), "");
  EXPECT_NE(warnings("0", "0", "-9.81").find("by 0 9.81 0; hint"), std::string::npos);
  EXPECT_NE(warnings("0", "1", "0").find("size of 1 m/s^2"), std::string::npos);
}

TEST_F(SmoothCommand, WarnsOfNamedFlightsThatItMoves) {
  const auto motion = synthetic_throw(10.0, 1);
  ASSERT_GE(motion.flights.size(), 2u);
  put(folder_ / "ball.csv", csv(measure(motion, 60.0, 0.002, 1)));
  const auto warnings = [&](double early_s) {
    std::string flights = "release_s,landing_s\n";
    for (const auto& flight : motion.flights)
      flights += fmt::format("{},{}\n", flight.release_s - early_s, flight.landing_s);
    put(folder_ / "flights.csv", flights);
    ::testing::internal::CaptureStderr();
    run({"--gravity", "0", "9.81", "0", path("ball.csv"), "--sigma", "0.002", "--flights",
         path("flights.csv"), "-o", path("out"), "--overwrite"});
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings(0.0), "");
  EXPECT_NE(warnings(0.15).find("does not fit free fall"), std::string::npos);
}

TEST_F(SmoothCommand, NeverOverwritesSilently) {
  put(folder_ / "a.csv", csv(sine(2.0, 1)));
  for (const char* name : {"a.csv", "a.flights.csv", "smooth.json"}) {
    write_file(folder_ / "out" / name, "precious", false);
    EXPECT_EQ(run({path("a.csv"), "-o", path("out")}), 2);
    EXPECT_EQ(read_file(folder_ / "out" / name), "precious");
    fs::remove(folder_ / "out" / name);
  }
  EXPECT_EQ(run({path("a.csv"), "-o", folder_.path().string(), "--overwrite"}), 2);  // the input
  EXPECT_TRUE(read_file(folder_ / "a.csv").starts_with("time_s,x_m,y_m,z_m\n"));
}

TEST_F(SmoothCommand, ExplainsWrongUsage) {
  put(folder_ / "a.csv", csv(sine(2.0, 1)));
  put(folder_ / "few.csv", "0,1,2,3\n1,2,3,4\n");
  put(folder_ / "flights.csv", "0.5,1.0\n");
  const auto expect_refused = [&](std::vector<std::string> arguments, int code,
                                  const std::string& message) {
    arguments.insert(arguments.end(), {"-o", path("out")});
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run(arguments), code);
    const auto error = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_NE(error.find("\nhint: "), std::string::npos) << error;
  };
  expect_refused({}, 2, "missing TRACK; usage: touchtrace smooth TRACK... [OPTIONS]");
  expect_refused({path("a.csv"), "--flights", "find"}, 2, "0 9.81 0 in a camera's frame");
  expect_refused({path("a.csv"), "--gravity", "0", "9.81"}, 2, "needs 3 numbers, X Y Z, not 2");
  expect_refused({path("a.csv"), "--gravity", "0", "y", "0"}, 2, "must be a number, not 'y'");
  expect_refused({path("a.csv"), "--gravity", "0", "0", "0", "--flights", "find"}, 2, "0 0 0");
  expect_refused({path("a.csv"), path("few.csv"), "--gravity", "0", "0", "-9.81", "--flights",
                  path("flights.csv")},
                 2, "cannot be used with 2 tracks");
  expect_refused({path("a.csv"), "--gravity", "0", "0", "-9.81", "--flights", "fnd"}, 3,
                 "cannot read fnd");
  expect_refused({path("few.csv")}, 3, "cannot be estimated from its 2 samples");
  expect_refused({path("missing.csv")}, 3, "missing.csv");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

/// Positions that overflow double precision: that track fails, the other one does not.
TEST_F(SmoothCommand, ReportsTracksThatFail) {
  put(folder_ / "good.csv", csv(sine(2.0, 1)));
  std::string extreme;
  for (int i = 0; i < 100; ++i) extreme += fmt::format("{},{}e160,0,0\n", i, i % 2 ? 1 : -1);
  put(folder_ / "extreme.csv", extreme);
  EXPECT_EQ(run({path("extreme.csv"), path("good.csv"), "--sigma", "0.001", "-o", path("out")}), 3);
  const auto tracks = summary()["tracks"];
  EXPECT_EQ(tracks[0]["status"], "not converged");
  EXPECT_EQ(tracks[1]["status"], "converged");
  EXPECT_FALSE(fs::exists(folder_ / "out/extreme.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/good.csv"));
}

}  // namespace
}  // namespace touchtrace::smooth_command
