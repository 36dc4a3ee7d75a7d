#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove_protocol.h"
#include "pipeline/cli/commands.h"
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
  set.input("recording", o.recording, "whose glove it is");
  set.choice("protocol", o.protocol, "of the glove's device", glove_protocol_names());
  set.integer("glove", o.glove, "which one, where there are two", 1, 2);
  set.text("output", o.output, "a file for the bytes (default: stdout)");
  set.flag("live", o.live, "send each frame when it came, not all at once");
}

void check(const SendOptions& options, const Invocation& invocation) {
  if (options.live && !options.output.empty())
    throw usage_error("a file has no time to keep", "leave out --live or --output");
  if (!options.output.empty()) return;
  if (invocation.json)
    throw usage_error("stdout cannot carry both the bytes and --json", "give --output");
  if (isatty(STDOUT_FILENO))
    throw usage_error("a terminal cannot show what a glove sends", "give --output, or a pipe");
}

GloveStream glove_of(const SendOptions& options) {
  const RecordingReader reader(options.recording);
  const Recording& recording = reader.recording();
  const auto index = static_cast<std::size_t>(options.glove - 1);
  if (index >= recording.gloves.size())
    throw data_error(fmt::format("{} has {} gloves", options.recording, recording.gloves.size()),
                     "choose another with --glove");
  return recording.gloves[index];
}

/// Ctrl-C ends it: recordings pause for as long as their people do.
void wait_until(Clock::time_point due) {
  constexpr std::chrono::milliseconds at_once(100);
  for (auto now = Clock::now(); now < due; now = Clock::now()) {
    throw_if_interrupted();
    std::this_thread::sleep_until(std::min(due, now + at_once));
  }
}

/// Calls `put` with the bytes of each frame, if `live` as long after the first as it came.
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
    throw failure("standard output cannot be written", "check what reads it, or the disk");
}

nlohmann::json summary(const SendOptions& options, const GloveStream& glove,
                       const GloveProtocol& protocol, std::size_t bytes) {
  const double bits_a_s = 10.0 * glove.info.rate_hz * static_cast<double>(bytes) /
                          static_cast<double>(std::max<std::size_t>(1, glove.frames()));
  return {{"output", options.output}, {"protocol", protocol.name},
          {"baud", protocol.baud},    {"frames", glove.frames()},
          {"bytes", bytes},           {"line_load", bits_a_s / protocol.baud}};
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
    fmt::print("{}: {} frames, {} bytes, {:.0f} % of what {} baud carry\n", options.output,
               glove.frames(), all.size(), 100.0 * row["line_load"].get<double>(), protocol.baud);
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
      "send", "send what a recording's glove measured byte by byte, as its device would",
      {"touchtrace send wave.h5 --output glove.bin",
       "touchtrace send wave.h5 --protocol wiresens --live | socat - PTY,link=/tmp/glove,raw"},
      run);
}

}  // namespace touchtrace::cli
