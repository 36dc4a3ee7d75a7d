#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/log.h"
#include "pipeline/acquire/transport/transport.h"
#include "tests/pipeline/import_samples.h"
#include "tests/support/command_line.h"
#include "tests/support/pseudo_terminal.h"

namespace touchtrace {
namespace {

using testing::PseudoTerminal;
using testing::run_touchtrace;

/// Output of a command on stdout as JSON.
nlohmann::json json_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run_touchtrace(arguments), 0);
  return nlohmann::json::parse(::testing::internal::GetCapturedStdout());
}

/// Frames as a device counts them: 6 x 16 taxels of 8 bits.
GloveStream device_frames(std::size_t frames) {
  RandomStream random(3, "device");
  GloveStream glove;
  glove.info.rows = 6, glove.info.cols = 16, glove.info.bits = 8;
  for (std::size_t i = 0; i < frames; ++i) {
    glove.sequence.push_back(i);
    for (int k = 0; k < glove.info.taxels(); ++k)
      glove.counts.push_back(static_cast<std::uint16_t>(random.below(256)));
  }
  return glove;
}

std::vector<std::string> arguments(const std::string& port, const std::string& protocol,
                                   const fs::path& output, std::vector<std::string> more = {}) {
  more.insert(more.begin(),
              {"record", "--glove", port, "--protocol", protocol, "--rows", "6", "--cols", "16",
               "--bits", "8", "--rate-hz", "50", "--rest-seconds", "0", "--output", output});
  return more;
}

/// Sends frames at 100 Hz.
void send(const PseudoTerminal& device, const std::string& protocol, const GloveStream& glove,
          std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    device.send(find_glove_protocol(protocol).encode(glove, i));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void wait_for(const fs::path& file) {
  while (!fs::exists(file)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// Summary of a recording during which `send` runs and then interrupts it.
template <class Send>
nlohmann::json record_while(const std::vector<std::string>& arguments, const fs::path& log,
                            const Send& send) {
  std::thread sender([&] {
    wait_for(log);
    send();
    std::raise(SIGINT);
  });
  const auto summary = json_of(arguments);
  sender.join();
  return summary;
}

/// Recording of a file whose lines have 1 to 3 digits per count, or whose frames 20 to 29 are lost.
GloveStream replayed(const std::string& protocol, const std::string& speed) {
  const TemporaryFolder folder;
  GloveStream glove = device_frames(60);
  for (std::size_t i = 0; i < glove.counts.size() / 2; ++i) glove.counts[i] = 1;
  std::string bytes;
  for (std::size_t i = 0; i < 60; ++i) {
    if (find_glove_protocol(protocol).has_numbers && i >= 20) glove.sequence[i] += 10;
    bytes += find_glove_protocol(protocol).encode(glove, i);
  }
  testing::put(folder / "glove.bin", bytes);
  EXPECT_EQ(run_touchtrace(
                arguments(folder / "glove.bin", protocol, folder / "a.h5", {"--speed", speed})),
            0);
  return RecordingReader(folder / "a.h5").recording().gloves.at(0);
}

TEST(RecordCommand, FramesOfAFileAreAtTheNominalRate) {
  for (const std::string protocol : {"stag", "vitac", "actionsense", "mit-rows"})
    for (const char* speed : {"0", "20"}) {
      const GloveStream glove = replayed(protocol, speed);
      EXPECT_GE(glove.frames(), 59u);
      EXPECT_EQ(glove.sequence.back() - glove.sequence.front() >= 69, protocol == "actionsense");
      for (std::size_t i = 0; i < glove.frames(); ++i)
        ASSERT_NEAR(glove.host_time_s[i] - glove.host_time_s[0],
                    static_cast<double>(glove.sequence[i] - glove.sequence[0]) / 50.0, 1e-9)
            << protocol << ", frame " << i;
    }
}

TEST(RecordCommand, AFileIsReplayedAtItsSpeed) {
  const double start_s = monotonic_s();
  replayed("stag", "4");
  EXPECT_GE(monotonic_s() - start_s, 59 / 200.0);
  EXPECT_LT(monotonic_s() - start_s, 5.0);
}

TEST(RecordCommand, RecordsWhatADeviceSends) {
  for (const std::string protocol : {"actionsense", "mit-rows"}) {
    const TemporaryFolder folder;
    const PseudoTerminal device;
    const GloveStream glove = device_frames(50);
    const auto summary =
        record_while(arguments(device.path(), protocol, folder / "a.h5"), folder / "a.h5.log",
                     [&] { send(device, protocol, glove, 0, 50); });
    EXPECT_EQ(summary["glove_frames"], 50u) << protocol;
    EXPECT_EQ(summary["torn"], 0u);
    const RecordingReader reader(folder / "a.h5");
    const GloveStream& read = reader.recording().gloves.at(0);
    EXPECT_EQ(read.counts, glove.counts);
    EXPECT_EQ(read.sequence, glove.sequence);
    EXPECT_EQ(reader.recording().clips.size(), 1u);
    EXPECT_FALSE(fs::exists(folder / "a.h5.log"));
  }
}

TEST(RecordCommand, AsksADeviceThatWaitsForRequests) {
  const TemporaryFolder folder;
  const PseudoTerminal device;
  const GloveStream glove = device_frames(20);
  const auto answer = [&] {
    for (std::size_t i = 0; i < 20;)
      for (const char request : device.receive())
        if (request == 'a' && i < 20) device.send(encode_actionsense(glove, i++));
  };
  const auto summary = record_while(arguments(device.path(), "actionsense", folder / "a.h5"),
                                    folder / "a.h5.log", answer);
  EXPECT_GE(summary["glove_frames"], 19u);
  EXPECT_NEAR(summary["rate_hz"].get<double>(), 50.0, 10.0);
}

TEST(RecordCommand, ContinuesWhenTheGloveIsPluggedInAgain) {
  const TemporaryFolder folder;
  const fs::path port = folder / "glove";
  const GloveStream glove = device_frames(60);
  std::thread sender([&] {
    {
      PseudoTerminal device;
      fs::create_symlink(device.path(), port);
      wait_for(folder / "a.h5.log");
      send(device, "mit-rows", glove, 0, 30);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    fs::remove(port);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    const PseudoTerminal device;
    fs::create_symlink(device.path(), port);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    send(device, "mit-rows", glove, 30, 60);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::raise(SIGINT);
  });
  wait_for(port);
  const auto summary = json_of(arguments(port.string(), "mit-rows", folder / "a.h5"));
  sender.join();
  EXPECT_EQ(summary["reconnections"], 1u);
  EXPECT_EQ(summary["glove_frames"], 60u);
  const RecordingReader reader(folder / "a.h5");
  const GloveStream& read = reader.recording().gloves.at(0);
  EXPECT_EQ(read.counts, glove.counts);
  ASSERT_EQ(reader.recording().clips.size(), 2u);
  EXPECT_GT(reader.recording().clips[1].start_s - reader.recording().clips[0].end_s, 0.3);
  // 0.75 s without frames at the nominal 50 Hz.
  EXPECT_NEAR(static_cast<double>(read.sequence[30] - read.sequence[29]), 40.0, 15.0);
}

TEST(RecordCommand, APauseOfAGloveWithoutFrameNumbersIsAGap) {
  const TemporaryFolder folder;
  const PseudoTerminal device;
  const GloveStream glove = device_frames(40);
  const auto send_twice = [&] {
    send(device, "mit-rows", glove, 0, 20);
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    send(device, "mit-rows", glove, 20, 40);
  };
  const auto summary = record_while(arguments(device.path(), "mit-rows", folder / "a.h5"),
                                    folder / "a.h5.log", send_twice);
  EXPECT_EQ(summary["glove_frames"], 40u);
  const RecordingReader reader(folder / "a.h5");
  const auto& sequence = reader.recording().gloves.at(0).sequence;
  EXPECT_EQ(reader.recording().clips.size(), 2u);
  EXPECT_NEAR(static_cast<double>(sequence[20] - sequence[19]), 0.7 * 50.0, 10.0);
}

/// Replays images while a device on a pseudo-terminal sends frames.
TEST(RecordCommand, RecordsGloveAndCameraTogether) {
  const TemporaryFolder folder;
  const PseudoTerminal device;
  const GloveStream glove = device_frames(40);
  write_import_tum(folder / "images");
  const auto summary = record_while(
      arguments(device.path(), "mit-rows", folder / "a.h5", {"--camera", folder / "images"}),
      folder / "a.h5.log", [&] { send(device, "mit-rows", glove, 0, 40); });
  EXPECT_EQ(summary["glove_frames"], 40u);
  EXPECT_EQ(summary["color_images"], std::size_t{import_frames});
  EXPECT_EQ(summary["depth_images"], std::size_t{import_frames});
  const RecordingReader reader(folder / "a.h5");
  const Recording& recording = reader.recording();
  EXPECT_EQ(recording.gloves.at(0).counts, glove.counts);
  ASSERT_EQ(recording.camera_times.frames(), std::size_t{import_frames});
  EXPECT_NEAR(recording.camera_times.host_time_s[3] - recording.camera_times.host_time_s[0], 0.1,
              1e-5);
  EXPECT_LT(std::abs(recording.camera_times.host_time_s[0] - recording.gloves[0].host_time_s[0]),
            1.0);
  EXPECT_DOUBLE_EQ(recording.camera.depth_unit_m, 1.0 / 5000.0);
  EXPECT_TRUE(recording.camera.is_registered);
  ASSERT_TRUE(recording.camera.color_camera);
  EXPECT_DOUBLE_EQ(recording.camera.color_camera->fx, 7.0);
  for (int i = 0; i < import_frames; ++i) {
    const RgbdFrame frame = reader.read_camera_frame(static_cast<std::size_t>(i));
    EXPECT_EQ(frame.color[3], 100 + i) << "red comes first";
    EXPECT_EQ(frame.depth[2 * import_width + 3], 5000 + 5 * i);
  }
}

TEST(RecordCommand, RecordsACameraAlone) {
  const TemporaryFolder folder;
  write_import_tum(folder / "images");
  const auto summary = json_of({"record", "--camera", (folder / "images").string(), "--output",
                                (folder / "a.h5").string(), "--speed", "0"});
  EXPECT_EQ(summary["color_images"], std::size_t{import_frames});
  EXPECT_EQ(RecordingReader(folder / "a.h5").recording().clips.size(), 1u);
  EXPECT_EQ(
      run_touchtrace({"record", "--camera", "/dev/null", "--output", (folder / "b.h5").string()}),
      3);
}

TEST(RecordCommand, ReplaysAFile) {
  const TemporaryFolder folder;
  const GloveStream glove = device_frames(200);
  std::string bytes;
  for (std::size_t i = 0; i < 200; ++i) bytes += encode_stag(glove, i);
  testing::put(folder / "glove.bin", bytes);
  const auto summary =
      json_of(arguments(folder / "glove.bin", "stag", folder / "a.h5", {"--speed", "0"}));
  EXPECT_EQ(summary["glove_frames"], 199u);
  EXPECT_NEAR(summary["duration_s"].get<double>(), 199 / 50.0, 0.3 * 199 / 50.0);
}

TEST(RecordCommand, NoFramesIsAnErrorThatLeavesNothing) {
  const TemporaryFolder folder;
  testing::put(folder / "noise.bin", std::string(10'000, '\xff'));
  EXPECT_EQ(run_touchtrace(
                arguments(folder / "noise.bin", "mit-rows", folder / "a.h5", {"--speed", "0"})),
            3);
  EXPECT_FALSE(fs::exists(folder / "a.h5.log"));
  EXPECT_FALSE(fs::exists(folder / "a.h5"));
}

TEST(RecordCommand, InvalidUseHasExitCode) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_touchtrace({"record", "--output", (folder / "a.h5").string()}), 2);
  EXPECT_EQ(run_touchtrace(arguments("/dev/none", "stag", folder / "a.h5")), 3);
  EXPECT_EQ(run_touchtrace(arguments("/dev/none", "stag", folder / "a.h5", {"--polarity", "2"})),
            2);
  EXPECT_EQ(run_touchtrace(arguments("/dev/none", "jq20", folder / "a.h5")), 3);  // 96 taxels
}

TEST(RecordCommand, RecoverFinishesALog) {
  const TemporaryFolder folder;
  const PseudoTerminal device;
  const GloveStream glove = device_frames(20);
  record_while(arguments(device.path(), "mit-rows", folder / "a.h5"), folder / "a.h5.log", [&] {
    send(device, "mit-rows", glove, 0, 20);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    fs::copy_file(folder / "a.h5.log", folder / "b.h5.log");  // as a killed process leaves it
  });
  const std::string log = (folder / "b.h5.log").string();
  EXPECT_EQ(run_touchtrace(arguments(device.path(), "mit-rows", folder / "b.h5")),
            2);  // the log exists
  EXPECT_EQ(json_of({"recover", log})["glove_frames"], 20u);
  EXPECT_EQ(RecordingReader(folder / "b.h5").recording().gloves.at(0).counts, glove.counts);
  EXPECT_EQ(run_touchtrace({"recover", log}), 2);  // the recording exists
  fs::resize_file(log, fs::file_size(log) - 10);
  EXPECT_EQ(json_of({"recover", log, "--overwrite"})["glove_frames"], 19u);
  EXPECT_EQ(run_touchtrace({"recover", device.path()}), 2);
}

}  // namespace
}  // namespace touchtrace
