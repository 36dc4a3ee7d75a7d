#include "pipeline/acquire/track_file.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using testing::put, testing::TemporaryFolder;

TrackFile track_of(const std::string& text, const TrackOptions& options = {}) {
  const TemporaryFolder folder;
  put(folder / "track.csv", text);
  return read_track(folder / "track.csv", options);
}

/// Expects a data_error whose message contains all `parts`.
void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
  const std::string fault = testing::expect_error([&] { track_of(text); }, "");
  for (const auto& part : parts)
    EXPECT_NE(fault.find(part), std::string::npos) << "no '" << part << "' in: " << fault;
}

/// Expects the positions (1, 2, 3) and (1.5, 2, 3) m at 0.1 and 0.2 s.
void expect_two_points(const std::string& text) {
  const TrackFile read = track_of(text);
  ASSERT_EQ(read.track.size(), 2u) << text;
  EXPECT_EQ(read.origin_s, 0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_DOUBLE_EQ(read.track[i].time_s, i == 0 ? 0.1 : 0.2) << text;
    EXPECT_EQ(read.track[i].position_m, Eigen::Vector3d(i == 0 ? 1.0 : 1.5, 2.0, 3.0)) << text;
  }
}

TEST(TrackFile, ReadsEverySeparatorWithAndWithoutHeader) {
  expect_two_points("0.1,1,2,3\n0.2,1.5,2,3\n");
  expect_two_points("  0.1 1   2 3\n\n0.2 1.5 2 +3");
  expect_two_points("0.1\t1\t2\t3\r\n0.2\t1.5\t2\t3\r\n");
  expect_two_points("time_s;x_m;y_m;z_m\n0,1;1;2;3\n0,2;1,5;2;3\n");
  expect_two_points("\xEF\xBB\xBFt, x, y, z\n0.1, 1, 2, 3\n0.2, 1.5, 2, 3\n");
  expect_two_points("# made by hand\n0.1,1,2,3\n# a gap\n0.2,1.5,2,3\n");
}

TEST(TrackFile, FindsTheOnlyColumnsThatDifferByTheirAxis) {
  expect_two_points(
      "timestamp,true_hand_pos_X,true_hand_pos_Y,true_hand_pos_Z\n0.1,1,2,3\n0.2,1.5,2,3\n");
  expect_two_points(
      "time,hand_qx,hand_qy,hand_qz,hand_x_mm,hand_y_mm,hand_z_mm\n"
      "0.1,0,0,1,1000,2000,3000\n0.2,0,0,1,1500,2000,3000\n");
  expect_two_points(
      "time,hand_vx,hand_vy,hand_vz,indexXraw,indexYraw,indexZraw\n"
      "0.1,0,0,1,1,2,3\n0.2,0,0,1,1.5,2,3\n");
  expect_refused("time,qx,qy,qz\n0.1,0,0,1\n", {"no column for x, y, z"});
}

TEST(TrackFile, OneOfSeveralBodiesIsChosen) {
  const std::string text =
      "Time,A-pX,A-pY,A-pZ,B-pX,B-pY,B-pZ\n0.1,7,8,9,1,2,3\n0.2,7,8,9,1.5,2,3\n";
  expect_refused(text, {"several bodies: 'a_px', 'b_px'"});
  EXPECT_EQ(track_of(text, {.x_column = "B-pX"}).track[1].position_m,
            Eigen::Vector3d(1.5, 2.0, 3.0));
  EXPECT_THROW(track_of(text, {.x_column = "C-pX"}), Error);
}

TEST(TrackFile, TimesSince1970TellTheirUnit) {
  for (const char* zeros : {"", "000", "000000"}) {
    const auto row = [&](const char* ms) { return std::string(ms) + zeros + ",1,2,3\n"; };
    const TrackFile read =
        track_of("timestamp,x,y,z\n" + row("1705590721399") + row("1705590721413"));
    EXPECT_EQ(read.origin_s, 1705590721);
    EXPECT_NEAR(read.track[1].time_s, 0.413, 1e-9) << zeros;
  }
  expect_refused("timestamp,x,y,z\n7e11,1,2,3\n", {"out of range in seconds"});
}

TEST(TrackFile, RowsWithoutTimesHaveARate) {
  const TrackFile read = track_of("Frame,x,y,z\n7,1,2,3\n8,1,2,3\n9,1,2,4\n", {.rate_hz = 50.0});
  ASSERT_EQ(read.track.size(), 3u);
  EXPECT_DOUBLE_EQ(read.track[2].time_s, 0.04);
  EXPECT_EQ(read.track[2].position_m.z(), 4.0);
}

TEST(TrackFile, ARateDoesNotReplaceTimes) {
  EXPECT_THROW(track_of("time_s,x,y,z\n0.0,1,2,3\n0.1,1,2,3\n", {.rate_hz = 50.0}), Error);
}

TEST(TrackFile, FindsColumnsByNameAndUnit) {
  expect_two_points("z_m,name,y_m,x_m,time\n3,\"a,b\",2,1,0.1\n3,c,2,1.5,0.2\n");
  expect_two_points("\"Time [ms]\",\"X (mm)\",Y (cm),Z\n100,1000,200,3\n200,1500,200,3\n");
  expect_two_points("timestamp_us;tx;ty;tz\n100000;1;2;3\n200000;1.5;2;3\n");
  expect_two_points("# time_ms x_mm y_m z_m\n100 1000 2 3\n200 1500 2 3\n");  // numpy.savetxt
}

TEST(TrackFile, ReadsFeetInchesAndSpelledUnits) {
  const auto first = [](const std::string& names, const std::string& row) {
    return track_of(names + "\n" + row + "\n").track[0].position_m;
  };
  const Eigen::Vector3d expected(1.0, 2.0, 3.0);
  EXPECT_LT(
      (first("time,x [ft],y [ft],z [ft]", "0,3.2808399,6.5616798,9.8425197") - expected).norm(),
      1e-7);
  EXPECT_LT((first("t_msec,ball_x_in,ball_y_in,ball_z_in", "0,39.3700787,78.7401575,118.110236") -
             expected)
                .norm(),
            1e-7);
  EXPECT_LT(
      (first("time,x (\xC2\xB5m),y (\xC2\xB5m),z (\xC2\xB5m)", "0,1e6,2e6,3e6") - expected).norm(),
      1e-12);
  EXPECT_LT((first("time,x_millimeters,y_millimeters,z_millimeters", "0,1000,2000,3000") - expected)
                .norm(),
            1e-12);
  EXPECT_DOUBLE_EQ(track_of("time [\xCE\xBCs],x,y,z\n500000,1,2,3\n").track[0].time_s, 0.5);
}

TEST(TrackFile, ReadsDates) {
  const auto read =
      track_of("time,x_m,y_m,z_m\n2023-11-14T22:13:20.25Z,1,2,3\n2023-11-14 22:13:20.75,1,2,3\n");
  EXPECT_EQ(read.origin_s, 1'700'000'000);
  EXPECT_NEAR(read.track[0].time_s, 0.25, 1e-6);
  EXPECT_NEAR(read.track[1].time_s, 0.75, 1e-6);
}

/// Expects (1, 2, 3) and (1.5, 2, 3) m at 0.1 and 0.2 s for the body.
void expect_body(const std::string& text, const TrackOptions& options) {
  const TrackFile read = track_of(text, options);
  ASSERT_EQ(read.track.size(), 2u) << text;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(read.track[i].time_s, i == 0 ? 0.1 : 0.2, 1e-12) << text;
    EXPECT_LT((read.track[i].position_m - Eigen::Vector3d(i == 0 ? 1.0 : 1.5, 2.0, 3.0)).norm(),
              1e-12)
        << text;
  }
}

TEST(TrackFile, ReadsExportsOfMotionCapture) {
  const std::string motive =
      "Format Version,1.23,Take Name,a,Length Units,Millimeters,Coordinate Space,Global\n\n"
      ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker\n"
      ",Name,Tool,Tool,Tool,Tool,Tool,Tool,Tool,Tool\n"
      ",ID,\"D13274E4C75B11ED\",\"D13274E4C75B11ED\",,,,,,\n"
      ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Quality\n"
      "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n"
      "0,0.1,0,0,0,1,1000,2000,3000,.9\n1,0.2,0,0,0,1,1500,2000,3000,.9\n";
  expect_body(motive, {});
  expect_body(motive, {.x_column = "rigid_body_tool_position_x_millimeters"});
  const std::string nexus =
      "# a, b, c, d, e, f, g, h\nTrajectories,,,,,,,\n100,,,,,,,\n,,A:Hand,,,A:Ball,,\nFrame,Sub "
      "Frame,X,Y,Z,X,Y,Z\n"
      ",,mm,mm,mm,mm,mm,mm\n1,0,0,0,0,1000,2000,3000\n2,0,0,0,0,1500,2000,3000\n";
  EXPECT_EQ(track_of(nexus, {.x_column = "a_ball_x_mm", .rate_hz = 10.0}).track[1].position_m,
            Eigen::Vector3d(1.5, 2.0, 3.0));
  const std::string trc =
      "PathFileType\t4\t(X/Y/"
      "Z)\ta.trc\nDataRate\tNumMarkers\tUnits\tRate\tStart\n100\t2\tmm\t100\t1\n"
      "Frame#\tTime\tHand\t\t\tBall\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\t\n"
      "1\t0.1\t0\t0\t0\t1000\t2000\t3000\t\t\t\n2\t0.2\t0\t0\t0\t1500\t2000\t3000\t\t\t\n";
  expect_body(trc, {.x_column = "ball_x2_mm"});
}

TEST(TrackFile, ReadsTumTrajectories) {
  expect_two_points("# timestamp tx ty tz qx qy qz qw\n0.1 1 2 3 0 0 0 1\n0.2 1.5 2 3 0 0 0 1\n");
  expect_two_points("0.1 1 2 3 0 0 0 1\n0.2 1.5 2 3 0 0 0 1\n");
}

TEST(TrackFile, ReadsStandardDeviations) {
  const auto expect_sigma = [](const std::string& text, const Eigen::Vector3d& sigma_m) {
    const TrackFile read = track_of(text);
    EXPECT_TRUE(read.has_sigmas);
    EXPECT_LT((read.track.front().sigma_m - sigma_m).norm(), 1e-15) << text;
  };
  expect_sigma("0 1 2 3 0.001 0.002 0.003\n", {0.001, 0.002, 0.003});
  expect_sigma("t,x,y,z,sigma_x_mm,sigma_y_mm,sigma_z_m\n0,1,2,3,1,2,0.003\n",
               {0.001, 0.002, 0.003});
  expect_sigma("t,x,y,z,sigma_m\n0,1,2,3,0.004\n", {0.004, 0.004, 0.004});
  const TrackFile without = track_of("0 1 2 3\n");
  EXPECT_FALSE(without.has_sigmas);
  EXPECT_TRUE(without.track.front().sigma_m.hasNaN());
  expect_refused("t,x,y,z,sigma_x_m\n0,1,2,3,1\n", {"some axes only"});
  expect_refused("0 1 2 3 0.001 0 0.003\n", {"sigma_y '0' is not positive"});
  expect_refused("0 1 2 3 0.001 nan 0.003\n", {"sigma_y 'nan' is not positive"});
}

TEST(TrackFile, KeepsNanosecondsSince1970) {
  for (const char* text :
       {"timestamp_ns,x,y,z\n1700000000123456789,1,2,3\n1700000000123456790,1,2,3\n",
        "1700000000.123456789 1 2 3\n1700000000.123456790 1 2 3\n"}) {
    const TrackFile read = track_of(text);
    ASSERT_EQ(read.track.size(), 2u);
    EXPECT_EQ(read.origin_s, 1700000000);
    EXPECT_EQ(time_text(read.origin_s, read.track[0].time_s), "1700000000.123456789");
    EXPECT_EQ(time_text(read.origin_s, read.track[1].time_s), "1700000000.12345679");
  }
  EXPECT_EQ(time_text(0, 0.1), "0.1");
  EXPECT_EQ(time_text(-2000000, 0.25), "-1999999.75");
  EXPECT_EQ(time_text(1700000000, 3.0), "1700000003.0");
}

TEST(TrackFile, SkipsAndCountsRowsWithoutPosition) {
  const TrackFile read =
      track_of("t,x,y,z\n0.1,1,2,3\n0.2,,,\n0.3,nan,NaN,nan\n0.4,1,null,3\n0.5,4,5,6\n");
  EXPECT_EQ(read.track.size(), 2u);
  EXPECT_EQ(read.num_skipped, 3u);
  EXPECT_EQ(track_of("0.1\t1\t2\t3\n0.2\t\t\t\n").num_skipped, 1u);
  expect_refused("t,x,y,z\n1,,,\n", {"no row with a position"});
}

TEST(TrackFile, NamesMissingAndAmbiguousColumns) {
  expect_refused("time,east,y,up\n0,1,2,3\n", {"no column for x, z", "'time', 'east', 'y', 'up'"});
  expect_refused("t,time_s,x,y,z\n0,0,1,2,3\n", {"'t' and 'time_s'"});
  expect_refused("0,1,2,3,4\n", {"4 columns (time x y z)", "not 5"});
}

TEST(TrackFile, ListsFaultyLines) {
  expect_refused("t,x,y,z\n0,1,2,3\n1,one,2,3\n", {"track.csv, line 3: x 'one' is not a number"});
  expect_refused("0,1,2,3\n1,1,2\n2,inf,2,3\n,1,2,3\n",
                 {"3 faulty lines", "line 2: 3 columns instead of 4",
                  "line 3: x 'inf' is not a finite number", "line 4: time is missing"});
  expect_refused("2,1,2,3\n1,1,2,3\n3,1,2,3\n", {"line 2: time '1' is before"});
  expect_refused("14036365797635,1,2,3\n", {"out of range in seconds", "time_ns"});
  std::string many = "0,1,2,3\n";
  for (int i = 0; i < 100; ++i) many += "1,\x1b[2Jx,2,3\n";
  expect_refused(many, {"100 faulty lines", "line 6: x '?[2Jx'", "and 95 more"});
}

TEST(TrackFile, RefusesFilesThatAreNoTracks) {
  expect_refused("", {"has no rows"});
  expect_refused("\n# nothing\n\n", {"has no rows"});
  expect_refused(std::string("\xff\xfe"
                             "1\0,\0",
                             6),
                 {"not a text file"});
  expect_refused(std::string(1 << 21, '1'), {"line 1: 2097152 bytes, more than the limit"});
  expect_refused("0,1,2,3\n" + std::string(1 << 21, ' '), {"line 2: 2097152 bytes"});
  std::string rows;
  for (std::size_t i = 0; i <= TrackFile::max_rows; ++i) rows += "1 1 1 1\n";
  expect_refused(rows, {"more rows than the limit of 1000000"});
  const TemporaryFolder folder;
  put(folder / "large.csv", "0,1,2,3\n");
  fs::resize_file(folder / "large.csv", (1u << 28) + 1);
  EXPECT_THROW(read_track(folder / "large.csv"), Error);
  EXPECT_THROW(read_track(folder / "missing.csv"), Error);
}

/// Random changes of valid files: a track or a data_error, nothing else.
TEST(TrackFile, DamagedFilesAreReadOrRefused) {
  const std::string valid = "# t x y z\ntime_ms;x_mm;y;z;sigma_m\n10;1,5;2;3;1\n20;1e-3;nan;3;2\n";
  const std::string bytes("0123456789.,;\t \n\r\"#-+einafxyz_\0\xff", 33);
  RandomStream random(1, "damage");
  int num_read = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = valid;
    for (std::uint64_t changes = 1 + random.below(4); changes > 0; --changes)
      text[random.below(text.size())] = bytes[random.below(bytes.size())];
    testing::expect_read_or_refused([&] {
      num_read += !track_of(text.substr(0, 1 + random.below(2 * text.size()))).track.empty();
    });
  }
  EXPECT_GT(num_read, 30);
}

/// White errors on a parabola, which third differences remove exactly, at uneven times. Standard
/// error of a median of 2000 correlated differences: about 4 %; the bound is four of these.
TEST(WhiteSigma, IsThatOfTheErrors) {
  RandomStream random(2, "white");
  Track track;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.01 * (i + 0.3 * random.uniform());
    track.push_back({t,
                     {t * t + random.normal(0.0, 1e-3), 2.0 * t + random.normal(0.0, 2e-3), 1.0},
                     Eigen::Vector3d::Zero()});
  }
  const Eigen::Vector3d sigma_m = estimate_white_sigma(track);
  EXPECT_NEAR(sigma_m.x(), 1e-3, 0.16e-3);
  EXPECT_NEAR(sigma_m.y(), 2e-3, 0.32e-3);
  EXPECT_DOUBLE_EQ(sigma_m.z(), 0.1 * sigma_m.y());
  track.resize(12);
  EXPECT_TRUE(estimate_white_sigma(track).hasNaN());
  EXPECT_TRUE(estimate_white_sigma(Track(50, {1.0, {1, 2, 3}, Eigen::Vector3d::Zero()})).hasNaN());
}

TEST(FlightFile, ReadsTimesOnTheClockOfTheTrack) {
  const TemporaryFolder folder;
  const auto flights_of = [&](const std::string& text, const TrackFile& track) {
    put(folder / "flights.csv", text);
    return read_flights(folder / "flights.csv", track);
  };
  const TrackFile track = track_of("1700000000.5 1 2 3\n1700000010.5 1 2 3\n");
  const auto flights =
      flights_of("landing_s,release_s\n1700000002.25,1700000002\n1700000004,1700000003\n", track);
  ASSERT_EQ(flights.size(), 2u);
  EXPECT_DOUBLE_EQ(flights[0].release_s, 2.0);
  EXPECT_DOUBLE_EQ(flights[0].landing_s, 2.25);
  const TrackFile plain = track_of("0 1 2 3\n10 1 2 3\n");
  EXPECT_EQ(flights_of("1 1.5\n2 2.5\n", plain).size(), 2u);
  for (const char* text :
       {"1 1.5\n1.4 2\n", "2 1\n", "20 21\n", "1 x\n", "1 nan\n", "1 2 3\n", "a,b\n1,2\n", ""})
    EXPECT_THROW(flights_of(text, plain), Error) << text;
}

}  // namespace
}  // namespace touchtrace
