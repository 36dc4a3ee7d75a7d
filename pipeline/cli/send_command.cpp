#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/record_devices.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct SendOptions {
  std::string recording, protocol = "actionsense", output;
  int glove = 1;
  bool live = false;
};

void describe(OptionSet& set, SendOptions& o) {
  set.input("recording", o.recording, "HDF5 with glove");
  describe_protocol(set, o.protocol);
  set.integer("glove", o.glove, "number of the glove if there are two", 1, 2);
  set.text("output", o.output, "file for the bytes; default: stdout").value("FILE");
  set.flag("live", o.live, "send frames at the times of the recording");
}

void check(const SendOptions& options, const Invocation& invocation) {
  if (options.live && !options.output.empty())
    throw usage_error("--live cannot be combined with --output", "leave out one of them");
  if (!options.output.empty()) return;
  if (invocation.json)
    throw usage_error("--json needs --output: standard output has the bytes", "use --output FILE");
  if (isatty(STDOUT_FILENO))
    throw usage_error("cannot write binary glove data to a terminal",
                      "use --output FILE or a pipe");
}

GloveStream glove_of(const SendOptions& options) {
  const RecordingReader reader(options.recording);
  const Recording& recording = reader.recording();
  const auto index = static_cast<std::size_t>(options.glove - 1);
  if (index >= recording.gloves.size())
    throw data_error(fmt::format("{} has {} gloves", options.recording, recording.gloves.size()),
                     "choose another with --glove N; the first is 1");
  return recording.gloves[index];
}

/// Waits in short steps, so that Ctrl-C works: pauses in recordings have any length.
void wait_until(Clock::time_point due) {
  constexpr std::chrono::milliseconds step(100);
  for (auto now = Clock::now(); now < due; now = Clock::now()) {
    throw_if_interrupted();
    std::this_thread::sleep_until(std::min(due, now + step));
  }
}

/// Calls `put` with the bytes of each frame; if `live`, at the times of the recording.
template <class Put>
void send(const GloveStream& glove, const GloveProtocol& protocol, bool live, Put&& put) {
  Progress progress("send", glove.frames());
  const auto start = Clock::now();
  for (std::size_t frame = 0; frame < glove.frames(); ++frame) {
    if (live)
      wait_until(start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                             glove.host_time_s[frame] - glove.host_time_s[0])));
    put(protocol.encode(glove, frame));
    progress.advance();
  }
}

void put_on_stdout(const std::string& bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout))
    throw failure("cannot write standard output", "check the reader of the pipe, or the disk");
}

nlohmann::json summary(const SendOptions& options, const GloveStream& glove,
                       const GloveProtocol& protocol, std::size_t bytes) {
  const double bits_per_s = 10.0 * glove.info.rate_hz * static_cast<double>(bytes) /
                            static_cast<double>(std::max<std::size_t>(1, glove.frames()));
  return {{"output", options.output}, {"protocol", protocol.name},
          {"baud", protocol.baud},    {"frames", glove.frames()},
          {"bytes", bytes},           {"line_load", bits_per_s / protocol.baud}};
}

void write_bytes(const SendOptions& options, const GloveStream& glove,
                 const GloveProtocol& protocol, const Invocation& invocation) {
  std::string all;
  send(glove, protocol, false, [&](const std::string& bytes) { all += bytes; });
  write_file(options.output, all, invocation.overwrite);
  const auto row = summary(options, glove, protocol, all.size());
  if (invocation.json)
    fmt::print("{}\n", row.dump(2));
  else
    fmt::print("{}: {} frames, {} bytes, {:.0f} % of {} baud\n", options.output, glove.frames(),
               all.size(), 100.0 * row["line_load"].get<double>(), protocol.baud);
}

ExitCode run(const SendOptions& options, const Invocation& invocation) {
  check(options, invocation);
  const GloveProtocol& protocol = find_glove_protocol(options.protocol);
  const GloveStream glove = glove_of(options);
  require_supported(protocol, glove.info);
  if (options.output.empty())
    send(glove, protocol, options.live, put_on_stdout);
  else
    write_bytes(options, glove, protocol, invocation);
  return ExitCode::done;
}

}  // namespace

Command send_command() {
  return make_command<SendOptions>(
      "send", "write a recorded glove stream as its device would send it",
      {"touchtrace send wave.h5 --output glove.bin",
       "touchtrace send wave.h5 --protocol wiresens --live | socat - PTY,link=/tmp/glove,raw"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
