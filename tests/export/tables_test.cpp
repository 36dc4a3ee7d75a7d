#include <gtest/gtest.h>

#include <sstream>

#include "engine/base/files.h"
#include "pipeline/acquire/import/glove_import.h"
#include "pipeline/export/export.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::expect_error;
using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  std::istringstream stream(read_file(file));
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// One predicted frame, numbers 1 to 36 divided by 8.
std::string prediction_line(double time_s) {
  nlohmann::json row{{"clip", 3}, {"time_s", time_s}, {"step", 1}, {"start", "label"}};
  int number = 0;
  for (const char* body : {"object", "hand"})
    for (const char* name : {"position_m", "position_m_low", "position_m_high", "velocity_m_per_s",
                             "velocity_m_per_s_low", "velocity_m_per_s_high"})
      for (int i = 0; i < 3; ++i) row[body][name].push_back(++number / 8.0);
  return row.dump() + "\n";
}

class Tables : public ::testing::Test {
 protected:
  void SetUp() override {
    sample_.recording.clips[1].object = "box, \"blue\"";
    write(sample_, folder_ / "r.h5");
    labels_ = sample_labels(sample_.recording);
    labels_.hand.position_m[4] = std::nan("");
    labels_.hand.quality[1] = quality_lost;
    write_labels(folder_ / "l.h5", labels_, false);
    put(folder_ / "p.jsonl", prediction_line(0.5) + prediction_line(0.75));
  }
  std::vector<std::filesystem::path> run(const char* format, const char* input,
                                         const char* output) {
    const auto path = folder_ / input;
    return export_file(format, {recognize_file(path), path, folder_ / output});
  }

  TemporaryFolder folder_;
  testing::SampleRecording sample_ = sample_recording();
  Labels labels_;
};

TEST_F(Tables, CsvOfLabelsHasNamedColumnsAndExactNumbers) {
  const auto files = run("csv", "l.h5", "o.csv");
  EXPECT_EQ(files, (std::vector{folder_ / "o.csv", folder_ / "o.clips.csv"}));
  const auto lines = lines_of(folder_ / "o.csv");
  ASSERT_EQ(lines.size(), 1 + labels_.time_s.size());
  EXPECT_TRUE(lines[0].starts_with(
      "time_s,clip,glove_frame,object_position_m_x,object_position_m_y,object_position_m_z,"
      "object_velocity_m_per_s_x,object_velocity_m_per_s_y,object_velocity_m_per_s_z,"
      "object_covariance_x_x,object_covariance_x_y,object_covariance_x_z,object_covariance_x_vx,"))
      << lines[0];
  EXPECT_TRUE(lines[0].ends_with(",hand_causal_velocity_m_per_s_z,hand_quality"));
  EXPECT_TRUE(lines[2].ends_with(",1")) << "quality of the second label";
  EXPECT_NE(lines[2].find(",nan,"), std::string::npos);
  const auto clips = lines_of(folder_ / "o.clips.csv");
  ASSERT_EQ(clips.size(), 3u);
  EXPECT_EQ(clips[0], "start_s,end_s,object,dropped");
  EXPECT_TRUE(clips[1].ends_with(",ball,0"));
  EXPECT_TRUE(clips[2].ends_with(",\"box, \"\"blue\"\"\",0")) << clips[2];
  testing::expect_python(folder_.path(), R"(
table = np.genfromtxt('o.csv', delimiter=',', names=True)
with h5py.File('l.h5') as l:
    assert (table['time_s'] == l['label/time_s'][:]).all()
    assert (table['object_covariance_vy_z'] == l['object/covariance'][:, 4, 2]).all()
    assert (table['hand_causal_position_m_y'] == l['hand/causal_position_m'][:, 1]).all()
)");
}

TEST_F(Tables, NpzOfLabelsHasTheArraysOfTheFile) {
  run("npz", "l.h5", "o.npz");
  testing::expect_python(folder_.path(), R"(
import zipfile
assert zipfile.ZipFile('o.npz').testzip() is None
o = np.load('o.npz')
with h5py.File('l.h5') as l:
    for name in 'hand', 'object':
        for array in 'position_m', 'velocity_m_per_s', 'covariance', 'causal_position_m', 'causal_velocity_m_per_s', 'quality':
            a, b = o[f'{name}_{array}'], l[f'{name}/{array}'][:]
            assert a.dtype == b.dtype and a.shape == b.shape and ((a == b) | np.isnan(b)).all(), array
    for name, path in ('time_s', 'label/time_s'), ('clip', 'label/clip'), ('glove_frame', 'label/glove_frame'):
        assert o[name].dtype == l[path].dtype and (o[name] == l[path][:]).all()
    assert (o['clips_start_s'] == l['clips/start_s'][:]).all()
assert o['clips_object'].tolist() == [b'ball', b'box, "blue"']
)");
}

TEST_F(Tables, TouchHasCountsAndPressure) {
  run("npz", "r.h5", "o.npz");
  run("csv", "r.h5", "o.csv");
  testing::expect_python(folder_.path(), R"(
o, table = np.load('o.npz'), np.genfromtxt('o.csv', delimiter=',', names=True)
with h5py.File('r.h5') as r:
    glove = r['glove0']
    counts = glove['counts'][:].astype(float)
    pressure = np.clip((counts - glove['baseline'][:]) / 1023, 0, 1) * glove['mask'][:]
    assert o['counts'].dtype == np.uint16 and (o['counts'] == counts).all()
    assert (o['sequence'] == glove['sequence'][:]).all() and (o['time_s'] == glove['host_time_s'][:]).all()
    assert o['pressure'].dtype == np.float32 and np.abs(o['pressure'] - pressure).max() < 2**-23
    assert o['pressure'].max() > 0.5 and (o['pressure'][:, 0, 4] == 0).all()
    assert (table['counts_5_3'] == counts[:, 5, 3]).all()
    assert (table['pressure_5_3'].astype('f4') == o['pressure'][:, 5, 3]).all()
    assert (o['taxels_exists'].reshape(6, 5) == glove['mask'][:]).all()
)");
}

TEST_F(Tables, TouchIsImportedAgain) {
  const GloveStream& glove = sample_.recording.gloves[0];
  for (const char* format : {"npz", "csv"}) {
    const std::string table = std::string("o.") + format;
    run(format, "r.h5", table.c_str());
    GloveOptions options;
    options.file = folder_ / table;
    options.polarity = 1, options.bits = 10;
    const auto [read, epoch_unix_s] = import_glove(options);
    EXPECT_EQ(epoch_unix_s, sample_.recording.epoch_unix_s);
    EXPECT_EQ(read.info.rows, 6);
    EXPECT_EQ(read.info.cols, 5);
    EXPECT_EQ(read.counts, glove.counts);
    EXPECT_EQ(read.host_time_s, glove.host_time_s);
  }
}

TEST_F(Tables, PredictionsHaveTheirBands) {
  run("npz", "p.jsonl", "o.npz");
  run("csv", "p.jsonl", "o.csv");
  testing::expect_python(folder_.path(), R"(
o = np.load('o.npz')
assert o['time_s'].tolist() == [0.5, 0.75] and o['start'].tolist() == [b'label'] * 2 and o['clip'].tolist() == [3, 3]
assert o['object_position_m'].tolist() == [[0.125, 0.25, 0.375]] * 2
assert o['hand_velocity_m_per_s_high'].tolist() == [[34 / 8, 35 / 8, 36 / 8]] * 2
)");
  EXPECT_TRUE(
      lines_of(folder_ / "o.csv")[0].starts_with("time_s,clip,step,start,hand_position_m_x"));
}

TEST_F(Tables, PredictionsOfALiveGloveBeginWithItsFirstWindow) {
  put(folder_ / "live.jsonl",
      "{\"time_s\":0.25,\"step\":0,\"start\":\"window\",\"object\":null,\"hand\":null}\n" +
          prediction_line(0.5));
  run("csv", "live.jsonl", "o.csv");
  EXPECT_EQ(lines_of(folder_ / "o.csv").size(), 2u);
}

TEST_F(Tables, MessagesOfPredictions) {
  export_file("rosbag2", {FileKind::predictions, folder_ / "p.jsonl", folder_ / "bag"});
  const std::string text = read_file(folder_ / "bag/metadata.yaml");
  EXPECT_NE(text.find("nanoseconds: 250000000\n  starting_time:\n    nanoseconds_since_epoch: "
                      "500000000\n  message_count: 8\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("name: /object/predicted/odometry\n        type: nav_msgs/msg/Odometry\n"),
            std::string::npos);
}

TEST_F(Tables, TumOfPredictions) {
  run("tum", "p.jsonl", "t");
  EXPECT_EQ(read_file(folder_ / "t/object.txt"),
            "# timestamp tx ty tz qx qy qz qw\n0.500000 0.125 0.25 0.375 0 0 0 1\n"
            "0.750000 0.125 0.25 0.375 0 0 0 1\n");
}

TEST_F(Tables, TumOfLabelsTakesUnixTimeFromTheRecording) {
  export_file("tum", {FileKind::labels, folder_ / "l.h5", folder_ / "t", folder_ / "r.h5"});
  EXPECT_TRUE(lines_of(folder_ / "t/object.txt").at(1).starts_with("1700000010.000000 "));
}

TEST_F(Tables, TumHasALineForEachMeasuredLabel) {
  labels_.hand.quality[2] = quality_follows_hand, labels_.hand.quality[3] = quality_gap;
  for (int axis = 0; axis < 3; ++axis) labels_.hand.position_m[6 + axis] = 0.125 * axis;
  write_labels(folder_ / "l.h5", labels_, true);
  run("tum", "l.h5", "t");
  const auto hand = lines_of(folder_ / "t/hand.txt"), object = lines_of(folder_ / "t/object.txt");
  EXPECT_EQ(hand.size(), labels_.time_s.size() - 1) << "a header, no lost label, none in a gap";
  EXPECT_EQ(object.size(), 1 + labels_.time_s.size());
  EXPECT_EQ(hand.at(2), fmt::format("{:.6f} 0 0.125 0.25 0 0 0 1", labels_.time_s[2]));
  expect_error([&] { run("tum", "l.h5", "t"); }, "exists", {});
}

TEST_F(Tables, FormatsFitTheKindOfTheFile) {
  EXPECT_EQ(formats_of(FileKind::labels),
            (std::vector<std::string>{"csv", "npz", "tum", "mcap", "rosbag2"}));
  EXPECT_EQ(formats_of(FileKind::recording),
            (std::vector<std::string>{"csv", "npz", "mcap", "rosbag2"}));
  EXPECT_EQ(formats_of(FileKind::model), (std::vector<std::string>{"onnx"}));
  expect_error([&] { run("onnx", "l.h5", "o"); },
               "formats of this file: csv, npz, tum, mcap, rosbag2", ExitCode::usage);
  expect_error([&] { run("tum", "r.h5", "o"); }, "is a recording, which cannot be written as tum",
               ExitCode::usage);
  expect_error([&] { run("npx", "l.h5", "o"); }, "did you mean 'npz'", ExitCode::usage);
  expect_error(
      [&] {
        export_file("csv", {FileKind::labels, "l.h5", "o", "r.h5"});
      },
      "--recording has no effect on csv", ExitCode::usage);
  expect_error(
      [&] {
        export_file("mcap", {FileKind::labels, "l.h5", "o", {}, true});
      },
      "--images needs a recording", ExitCode::usage);
}

TEST_F(Tables, OutputsAreNotReplacedUnasked) {
  put(folder_ / "o.clips.csv", "mine");
  expect_error([&] { run("csv", "l.h5", "o.csv"); }, "already exists", ExitCode::usage);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o.csv"));
  EXPECT_EQ(read_file(folder_ / "o.clips.csv"), "mine");
  run("tum", "p.jsonl", "t");
  expect_error([&] { run("tum", "p.jsonl", "t"); }, "already exists", ExitCode::usage);
}

TEST_F(Tables, OtherFilesAreRefused) {
  put(folder_ / "text", "hello, this is no file of touchtrace");
  put(folder_ / "short", "x");
  put(folder_ / "big_header", std::string("\xff\xff\xff\xff\xff\xff\xff\x7f{\"a\":1}", 15));
  for (const char* name : {"text", "short", "big_header", "missing"})
    expect_error([&] { recognize_file(folder_ / name); }, name);
  put(folder_ / "bad.jsonl", prediction_line(1.0) + "{\"clip\": 1}\n");
  expect_error([&] { run("csv", "bad.jsonl", "o.csv"); }, "bad.jsonl:2:");
  put(folder_ / "deep.jsonl", "{\"clip\":" + std::string(100'000, '['));
  expect_error([&] { run("csv", "deep.jsonl", "o.csv"); }, "too long");
  sample_.recording.gloves.clear();
  write(sample_, folder_ / "no_glove.h5");
  expect_error([&] { run("npz", "no_glove.h5", "o.npz"); }, "has no glove");
}

}  // namespace
}  // namespace touchtrace
