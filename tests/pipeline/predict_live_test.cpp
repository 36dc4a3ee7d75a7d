// `touchtrace predict --glove`.
#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "engine/base/files.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/glove_config.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/command_line.h"
#include "tests/support/http_client.h"
#include "tests/support/pseudo_terminal.h"
#include "tests/verify/record/live_rows.h"
#include "tests/verify/study/noise_model.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::PseudoTerminal;
using testing::TemporaryFolder;

constexpr double rate_hz = 15.0;

std::vector<json> rows_of(const std::vector<std::string>& arguments, int exit_code = 0) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(testing::run_touchtrace(arguments), exit_code);
  return parse_rows(::testing::internal::GetCapturedStdout());
}

class PredictLive : public ::testing::Test {
 protected:
  void write_model(ObjectEncoder object = ObjectEncoder::none, bool touch = true) {
    Runtime runtime(choose_device(""));
    write_noise_model(
        runtime, folder_ / "model",
        {.touch = touch, .rows = 16, .cols = 16, .embedding = 16, .hidden = 64, .object = object},
        rate_hz);
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void write_config(const GloveStream& glove) const {
    LearnedGlove learned;
    learned.baseline_counts = glove.info.baseline_counts;
    learned.polarity = glove.info.polarity;
    testing::put(folder_ / "glove.json",
                 glove_config_json("actionsense", glove.info, learned).dump());
  }
  void write_bytes(const GloveStream& glove) const {
    std::string bytes;
    for (std::size_t i = 0; i < glove.frames(); ++i) bytes += encode_actionsense(glove, i);
    testing::put(folder_ / "glove.bin", bytes);
  }
  std::vector<std::string> live(const std::string& port) const {
    return {"predict", "--model", at("model"), "--glove", port, "--glove-config", at("glove.json")};
  }

  /// Records the bytes and compares predictions of the recording with those of the bytes.
  void expect_equal_predictions() {
    EXPECT_EQ(testing::run_touchtrace({"record", "--glove", at("glove.bin"), "--glove-config",
                                       at("glove.json"), "--speed", "0", "--output", at("a.h5"),
                                       "--overwrite"}),
              0);
    const auto recorded = rows_of({"predict", "--model", at("model"), "--recording", at("a.h5")});
    auto arguments = live(at("glove.bin"));
    arguments.insert(arguments.end(), {"--speed", "0"});
    const auto predicted = rows_of(arguments);
    const RowComparison comparison = compare_rows(recorded, predicted);
    EXPECT_EQ(comparison.compared, recorded.size());
    EXPECT_GT(comparison.compared, 100u);
    EXPECT_EQ(comparison.unequal, 0u);
  }

  TemporaryFolder folder_;
};

TEST_F(PredictLive, EqualsPredictionsOfARecordingOfASimulatedGlove) {
  ASSERT_EQ(testing::run_touchtrace(
                {"simulate", at("scene.h5"), "--no-images", "--minutes", "0.2", "--clip-s", "12"}),
            0);
  const GloveStream glove = RecordingReader(folder_ / "scene.h5").recording().gloves.at(0);
  ASSERT_DOUBLE_EQ(glove.info.rate_hz, rate_hz);
  write_config(glove);
  ASSERT_EQ(testing::run_touchtrace({"send", at("scene.h5"), "--output", at("glove.bin")}), 0);
  for (const auto object : {ObjectEncoder::none, ObjectEncoder::joint}) {
    write_model(object);
    expect_equal_predictions();
  }
  write_model(ObjectEncoder::none, false);
  expect_equal_predictions();
}

TEST_F(PredictLive, LearnsTheBaselineAtRest) {
  const GloveStream glove = wavy_glove(32, 32, 60, rate_hz);
  write_bytes(glove), write_model();
  const auto rows = rows_of({"predict", "--model", at("model"), "--glove", at("glove.bin"),
                             "--speed", "0", "--rest-seconds", "0.97"});
  ASSERT_EQ(rows.size(), 60u);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(rows[i]["start"], "rest") << i;
  EXPECT_EQ(rows[15]["start"], "window");
  EXPECT_EQ(rows[15 + 9]["step"], 1);
  EXPECT_TRUE(rows[30]["latency_s"].is_null()) << "not at the glove's pace";
  double sum = 0.0;
  for (std::size_t taxel = 0; taxel < 1024; ++taxel) {
    std::vector<double> rest;
    for (std::size_t i = 0; i < 15; ++i) rest.push_back(glove.counts[1024 * i + taxel]);
    std::ranges::sort(rest);
    sum += std::max(0.0, glove.counts[1024 * 59 + taxel] - rest[7]) / 4095.0;
  }
  EXPECT_NEAR(rows[59]["touch"]["mean"].get<double>(), sum / 1024.0, 1e-6);
}

TEST_F(PredictLive, FollowsADeviceUntilCtrlC) {
  const GloveStream glove = wavy_glove(32, 32, 60, rate_hz);
  write_config(glove), write_model();
  const std::filesystem::path port = folder_ / "port";
  std::thread device([&] {
    std::size_t sent = 0;
    for (const std::size_t until : {25, 45}) {  // unplugged after 25 frames
      const PseudoTerminal terminal;
      std::filesystem::create_symlink(terminal.path(), port);
      while (sent < until)
        for (const char request : terminal.receive())
          if (request == 'a' && sent < until) terminal.send(encode_actionsense(glove, sent++));
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      std::filesystem::remove(port);
    }
    std::raise(SIGINT);
  });
  while (!std::filesystem::exists(port)) std::this_thread::yield();
  const auto rows = rows_of(live(port.string()));
  device.join();
  ASSERT_EQ(rows.size(), 45u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i]["clip"], i < 25 ? 0 : 1) << i;
    const int frame = static_cast<int>(i < 25 ? i : i - 25);
    EXPECT_EQ(rows[i]["step"], std::max(0, frame - 10 + 2)) << i;
    EXPECT_GT(rows[i]["latency_s"], 0.0);
    EXPECT_LT(rows[i]["latency_s"], 1.0);
  }
}

/// Redirects stderr to a pipe.
class StderrPipe {
 public:
  StderrPipe() : saved_(dup(STDERR_FILENO)) {
    EXPECT_EQ(pipe(ends_), 0);
    dup2(ends_[1], STDERR_FILENO);
  }
  ~StderrPipe() {
    dup2(saved_, STDERR_FILENO);
    for (const int end : {saved_, ends_[0], ends_[1]}) close(end);
  }
  StderrPipe(const StderrPipe&) = delete;
  StderrPipe& operator=(const StderrPipe&) = delete;

  /// First address that is printed.
  std::string read_url() const {
    std::string text;
    for (char c; read(ends_[0], &c, 1) == 1;) {
      text += c;
      const auto start = text.find("http://");
      if (c == ' ' && start != std::string::npos)
        return text.substr(start, text.size() - 1 - start);
    }
    return text;
  }

 private:
  int saved_, ends_[2];
};

/// Answers requests until it is stopped.
std::jthread device_thread(const PseudoTerminal& terminal, const GloveStream& glove) {
  return std::jthread([&](const std::stop_token& stop) {
    for (std::size_t sent = 0; !stop.stop_requested();)
      for (const char request : terminal.receive())
        if (request == 'a') terminal.send(encode_actionsense(glove, sent++ % glove.frames()));
  });
}

TEST_F(PredictLive, PredictAndRecordServeAPage) {
  const GloveStream glove = wavy_glove(32, 32, 244, rate_hz);
  write_config(glove), write_model();
  const PseudoTerminal terminal;
  const auto device = device_thread(terminal, glove);
  for (const bool is_predicted : {true, false}) {
    auto arguments = live(terminal.path());
    if (!is_predicted)
      arguments = {"record",   "--glove",        terminal.path(), "--output",
                   at("a.h5"), "--glove-config", at("glove.json")};
    arguments.emplace_back("--page");
    const StderrPipe standard_error;
    std::string html, events;
    std::thread viewer([&] {
      const testing::PageAddress page(standard_error.read_url());
      html = testing::HttpClient(page.port, page.get("")).read();
      testing::HttpClient reader(page.port, page.get("events"));
      reader.read("data: {");
      events = reader.read("}}\n\n");
      std::raise(SIGINT);
    });
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(testing::run_touchtrace(arguments), 0);
    ::testing::internal::GetCapturedStdout();
    viewer.join();
    EXPECT_NE(html.find("<title>touchtrace live</title>"), std::string::npos);
    for (const char* part : {"\"image\":{", "\"touch\":{", "\"rate_hz\":", "\"arrival_unix_s\":"})
      EXPECT_NE(events.find(part), std::string::npos) << part << events;
    EXPECT_EQ(events.find("\"latency_s\":") != std::string::npos, is_predicted);
  }
}

TEST_F(PredictLive, InvalidUseHasExitCode) {
  write_model();
  write_config(wavy_glove(32, 32, 1, rate_hz));
  testing::put(folder_ / "noise.bin", std::string(10'000, '\xff'));
  EXPECT_EQ(testing::run_touchtrace({"predict", "--model", at("model")}), 2);
  EXPECT_EQ(
      testing::run_touchtrace({"predict", "--model", at("model"), "--page", "--recording", "a.h5"}),
      2);
  auto arguments = live(at("noise.bin"));
  arguments.insert(arguments.end(), {"--speed", "0"});
  EXPECT_EQ(testing::run_touchtrace(arguments), 3) << "no frame";
  EXPECT_EQ(testing::run_touchtrace(live("/dev/none")), 3);
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--recording", "a.h5"},
                                               {"--labels", "a.labels.h5"},
                                               {"--restart-steps", "5"},
                                               {"--output", "a.jsonl"},
                                               {"--rows", "16"}}) {
    arguments = live(at("noise.bin"));
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(testing::run_touchtrace(arguments), 2) << more[0];
  }
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--rate-hz", "30"}, {"--protocol", "stag"}}) {
    arguments = live(at("noise.bin"));
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(testing::run_touchtrace(arguments), 3) << more[0];
  }
}

}  // namespace
}  // namespace touchtrace
