#include <fmt/core.h>
#include <unistd.h>

#include <chrono>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/recorder.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/glove_page.h"
#include "pipeline/cli/record_devices.h"

namespace touchtrace::cli {
namespace {

struct RecordOptions {
  std::string output, activity = "record", object = "object";
  double seconds = 0.0, rest_s = 2.0;
  bool page = false;
  int port = 0;
  DeviceOptions devices;
};

void describe(OptionSet& set, RecordOptions& o) {
  set.path("output", o.output, "recording (.h5)").value("FILE");
  set.number("seconds", o.seconds, "duration [s]; 0: until Ctrl-C", 0.0, 1e6);
  set.number("rest-seconds", o.rest_s,
             "time at the start in which nothing is touched: gives the baseline; 0: none", 0.0,
             1e4);
  set.text("activity", o.activity, "name of the activity");
  set.text("object", o.object, "name of the object");
  set.flag("page", o.page, "show the glove on a page that is served on 127.0.0.1");
  set.integer("port", o.port, "of the page; 0: any free one", 0, 65535);
  describe(set, o.devices);
}

SessionInfo describe_session(const RecordOptions& options, const Invocation& invocation) {
  SessionInfo session;
  session.activity = options.activity, session.object = options.object;
  session.protocol = options.devices.protocol;
  session.epoch_unix_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  session.rest_s = options.rest_s;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  session.provenance.options = invocation.options;
  return session;
}

std::string status_text(const Devices& devices, const Recorder& recorder) {
  std::string text =
      devices.glove ? fmt::format("glove {}; ", glove_text(devices.glove->status())) : "";
  if (!devices.cameras.empty())
    text += fmt::format("{} frames of all devices; ", recorder.written_frames());
  if (recorder.discarded_frames() > 0)
    text += fmt::format("{} frames lost: the disk is too slow; ", recorder.discarded_frames());
  return text + fmt::format("log {:.1f} MB", 1e-6 * static_cast<double>(recorder.log_bytes()));
}

/// Glove of the devices on a page; nullptr: not wanted.
std::unique_ptr<ShownGlove> show_glove(const RecordOptions& options, const SessionInfo& session,
                                       const Devices& devices) {
  if (!options.page) return nullptr;
  if (!devices.glove) throw usage_error("--page shows a glove", "give --glove PORT");
  return std::make_unique<ShownGlove>(*devices.glove, *session.glove, options.rest_s, options.port);
}

/// Records until the time is over, all sources have ended, or Ctrl-C.
void record(Recorder& recorder, const Devices& devices, double seconds) {
  const double start_s = monotonic_s(), period_s = isatty(STDERR_FILENO) ? 1.0 : 10.0;
  double next_report_s = start_s + period_s;
  while (!interrupted() && recorder.step()) {
    const double now_s = monotonic_s();
    if (seconds > 0.0 && now_s - start_s >= seconds) break;
    if (now_s < next_report_s) continue;
    Progress::report(status_text(devices, recorder));
    next_report_s += period_s;
  }
  recorder.finish();
  clear_interrupt();
}

/// Throws data_error, and removes the log, if nothing was recorded.
void require_frames(const Recorder& recorder, const GloveStatus& glove,
                    const DeviceOptions& options, const std::string& log) {
  if (recorder.written_frames() > 0) return;
  std::filesystem::remove(log);
  require_glove_frames(glove.counts, options.glove.empty() ? options.camera : options.glove);
}

nlohmann::json summarize(const std::string& output, const LogConversion& conversion,
                         const GloveStatus& glove, const Recorder& recorder) {
  nlohmann::json summary = to_json(conversion);
  const ParserCounts& counts = glove.counts;
  summary.update({{"output", output},
                  {"rate_hz", glove.rate_hz},
                  {"dropped", counts.dropped},
                  {"torn", counts.torn},
                  {"repeated", counts.repeated},
                  {"restarts", counts.restarts},
                  {"skipped_bytes", counts.skipped_bytes},
                  {"reconnections", glove.reconnections},
                  {"discarded", recorder.discarded_frames()}});
  return summary;
}

/// Converts the log and removes it. If that fails, the log is kept.
LogConversion convert(const std::string& log, const std::string& output, bool overwrite) {
  try {
    const LogConversion conversion = convert_log(log, output, overwrite);
    std::filesystem::remove(log);
    return conversion;
  } catch (const Error& error) {
    throw Error(error.code(), error.what(),
                fmt::format("{}; then `touchtrace recover {}`", error.hint(), log));
  }
}

ExitCode run(const RecordOptions& options, const Invocation& invocation) {
  { const OutputFile writable(options.output, invocation.overwrite); }
  SessionInfo session = describe_session(options, invocation);
  const Devices devices = open_devices(options.devices, session);
  const auto shown = show_glove(options, session, devices);
  auto sources = devices.sources();
  if (shown) sources.front() = shown.get();  // the glove is the first
  const std::string log = options.output + ".log";
  Recorder recorder(log, session, sources);
  record(recorder, devices, options.seconds);
  const GloveStatus glove = devices.glove_status();
  require_frames(recorder, glove, options.devices, log);
  const LogConversion conversion = convert(log, options.output, invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", summarize(options.output, conversion, glove, recorder).dump(2));
  else
    fmt::print("{}: {}\n{}\n", options.output, conversion.text(), status_text(devices, recorder));
  return ExitCode::done;
}

}  // namespace

Command record_command() {
  return make_command<RecordOptions>(
      "record", "record a glove and a camera",
      {"touchtrace record --glove /dev/ttyACM0 --output my.h5",
       "touchtrace record --glove /dev/ttyUSB0 --protocol wiresens --seconds 60 --output my.h5",
       "touchtrace record --glove /dev/ttyACM0 --glove-config glove.json --page --output my.h5",
       "touchtrace record --glove glove.bin --protocol stag --speed 0 --output my.h5",
       "touchtrace record --glove /dev/ttyACM0 --camera /dev/video4 --depth-camera /dev/video2 "
       "--output my.h5",
       "touchtrace record --glove /dev/ttyACM0 --camera freenect --output my.h5"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
