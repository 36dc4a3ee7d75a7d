#include "tests/verify/record/live_latency.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <future>
#include <map>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/glove_config.h"
#include "pipeline/acquire/transport/transport.h"
#include "tests/support/pseudo_terminal.h"
#include "tests/verify/record/child_program.h"
#include "tests/verify/study/noise_model.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

void write_model(const fs::path& path, const ModelSpec& spec, double rate_hz) {
  Child([&] {
    Runtime runtime(choose_device(""));
    write_noise_model(runtime, path, spec, rate_hz);
    return 0;
  }).require_success("writing a model");
}

struct Line {
  double arrival_s, program_latency_s;
};

/// Lines of a pipe by the frame's number.
std::map<std::uint64_t, Line> read_lines(int pipe) {
  std::map<std::uint64_t, Line> lines;
  FILE* stream = fdopen(pipe, "r");
  char* text = nullptr;
  std::size_t size = 0;
  while (getline(&text, &size, stream) > 0) {
    const double now_s = monotonic_s();
    const auto row = nlohmann::json::parse(text);
    lines[row.at("sequence").get<std::uint64_t>()] = {now_s, row.at("latency_s").get<double>()};
  }
  free(text);
  fclose(stream);
  return lines;
}

/// Sends numbered frames at their times, without waiting for requests. Returns the times at which
/// they were handed to the terminal, all bytes at once.
std::vector<double> send_frames(const testing::PseudoTerminal& device, GloveStream glove,
                                int frames) {
  std::vector<double> sent_s;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < frames; ++i) {
    const std::size_t image = static_cast<std::size_t>(i) % glove.frames();
    glove.sequence[image] = static_cast<std::uint64_t>(i);
    const std::string bytes = encode_actionsense(glove, image);
    std::this_thread::sleep_until(start +
                                  i * std::chrono::duration<double>(1.0 / glove.info.rate_hz));
    throw_if_interrupted();
    sent_s.push_back(monotonic_s());
    if (!device.send(bytes)) break;  // nobody reads
  }
  return sent_s;
}

LiveLatency latency_of(const std::vector<double>& sent_s,
                       const std::map<std::uint64_t, Line>& lines) {
  LiveLatency latency;
  for (const auto& [sequence, line] : lines) {
    if (sequence >= sent_s.size()) continue;
    latency.seconds.push_back(line.arrival_s - sent_s[sequence]);
    latency.program_seconds.push_back(line.program_latency_s);
  }
  std::ranges::sort(latency.seconds), std::ranges::sort(latency.program_seconds);
  return latency;
}

/// Captured output of `touchtrace ARGUMENTS`.
std::string output_of(const fs::path& folder, const std::vector<std::string>& arguments) {
  const auto file = folder / "output.jsonl";
  const int descriptor = open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
  Child child([&] { return run_touchtrace(arguments); }, descriptor);
  close(descriptor);
  child.require_success("a prediction");
  return read_file(file);
}

}  // namespace

LiveLatency measure_live_latency(const fs::path& folder, double rate_hz, int frames) {
  const auto model = folder / "live.safetensors";
  write_model(model, ModelSpec{}, rate_hz);
  const Child busy([] {
    for (volatile std::uint64_t i = 0;;) i = i + 1;
    return 0;
  });
  const testing::PseudoTerminal device;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw failure("cannot create a pipe", "close other programs");
  std::future<std::map<std::uint64_t, Line>> lines;  // outlives the writer, whose end it waits for
  Child predict(
      [&] {
        return run_touchtrace({"predict", "--model", model.string(), "--glove", device.path(),
                               "--rate-hz", std::to_string(rate_hz), "--rest-seconds", "0"});
      },
      ends[1]);
  close(ends[1]);
  lines = std::async(std::launch::async, read_lines, ends[0]);
  predict.wait_until_open(device.path());
  const auto sent_s = send_frames(device, wavy_glove(32, 32, 200, rate_hz), frames);
  usleep(200'000);
  predict.signal(SIGINT), predict.wait();
  return latency_of(sent_s, lines.get());
}

RowComparison compare_live_with_recorded(const fs::path& folder) {
  constexpr double rate_hz = 15.0;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  ModelSpec spec;
  spec.object = ObjectEncoder::joint;
  write_model(folder / "object.safetensors", spec, rate_hz);
  const GloveStream glove = wavy_glove(32, 32, 600, rate_hz);
  std::string bytes;
  for (std::size_t i = 0; i < glove.frames(); ++i) bytes += encode_actionsense(glove, i);
  write_file(folder / "glove.bin", bytes, true);
  LearnedGlove learned;
  learned.baseline_counts = glove.info.baseline_counts;
  write_file(folder / "glove.json", glove_config_json("actionsense", glove.info, learned).dump(),
             true);
  const std::vector<std::string> device{"--glove", at("glove.bin"),  "--speed",
                                        "0",       "--glove-config", at("glove.json")};
  const auto with_device = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), device.begin(), device.end());
    return arguments;
  };
  output_of(folder, with_device({"record", "--output", at("live.h5"), "--overwrite"}));
  const std::vector<std::string> predict{"predict", "--model", at("object.safetensors")};
  auto from_recording = predict;
  from_recording.insert(from_recording.end(), {"--recording", at("live.h5")});
  return compare_rows(parse_rows(output_of(folder, from_recording)),
                      parse_rows(output_of(folder, with_device(predict))));
}

}  // namespace touchtrace
