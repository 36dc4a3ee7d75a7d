#include <fmt/core.h>
#include <unistd.h>

#include <chrono>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/recorder.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct RecordOptions {
  std::string output, glove, protocol = "actionsense", activity = "record", object = "object";
  int baud = 0, rows = 0, cols = 0, bits = 0;
  double rate_hz = 0.0, rest_s = 2.0, seconds = 0.0, speed = 1.0;
  std::string polarity;
};

void describe(OptionSet& set, RecordOptions& o) {
  set.path("output", o.output, "recording (.h5)").value("FILE");
  set.number("seconds", o.seconds, "duration [s]; 0: until Ctrl-C", 0.0, 1e6);
  set.text("activity", o.activity, "name of the activity");
  set.text("object", o.object, "name of the object");
  set.group("Glove");
  set.text("glove", o.glove, "serial port, usb:VENDOR:PRODUCT, or a file with the glove's bytes")
      .value("PORT");
  set.choice("protocol", o.protocol, "serial protocol of the device", glove_protocol_names());
  set.integer("baud", o.baud, "bits per second; 0: the protocol's", 0, 12'000'000);
  set.integer("rows", o.rows, "rows of taxels; 0: the protocol's", 0, 255);
  set.integer("cols", o.cols, "columns of taxels; 0: the protocol's", 0, 255);
  set.integer("bits", o.bits, "of the converter; 0: the protocol's", 0, 16);
  set.text("polarity", o.polarity,
           "+1: counts increase with pressure, -1: they decrease; default: the protocol's");
  set.number("rate-hz", o.rate_hz, "nominal frames per second; 0: the protocol's", 0.0, 1e4);
  set.number("rest-seconds", o.rest_s,
             "time at the start in which nothing is touched: gives the baseline; 0: none", 0.0,
             1e4);
  set.number("speed", o.speed, "of a file's bytes, relative to the device; 0: no pauses", 0.0, 1e6);
}

GloveInfo glove_info(const RecordOptions& options, const GloveProtocol& protocol) {
  GloveInfo info = protocol.usual_glove;
  info.name = protocol.name;
  if (options.rows > 0) info.rows = options.rows;
  if (options.cols > 0) info.cols = options.cols;
  if (options.bits > 0) info.bits = options.bits;
  if (options.rate_hz > 0.0) info.rate_hz = options.rate_hz;
  if (!options.polarity.empty() && options.polarity != "1" && options.polarity != "+1" &&
      options.polarity != "-1")
    throw usage_error(fmt::format("polarity '{}' is not +1 or -1", options.polarity),
                      "+1: counts increase with pressure");
  if (!options.polarity.empty()) info.polarity = options.polarity == "-1" ? -1 : 1;
  require_supported(protocol, info);
  return info;
}

SessionInfo describe_session(const RecordOptions& options, const Invocation& invocation) {
  SessionInfo session;
  session.activity = options.activity, session.object = options.object;
  session.protocol = options.protocol;
  session.epoch_unix_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  session.rest_s = options.rest_s;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  session.provenance.options = invocation.options;
  return session;
}

std::string status_text(const GloveStatus& glove, const Recorder& recorder) {
  const ParserCounts& counts = glove.counts;
  std::string text =
      fmt::format("glove {:.3f} Hz, {} frames, {} dropped, {} torn, {} repeated", glove.rate_hz,
                  counts.frames, counts.dropped, counts.torn, counts.repeated);
  if (!glove.is_connected) text += ", UNPLUGGED";
  if (glove.is_connected && counts.frames > 0 && monotonic_s() - glove.last_frame_s > 2.0)
    text += fmt::format(", nothing for {:.0f} s", monotonic_s() - glove.last_frame_s);
  if (glove.saturated_taxels > 0)
    text += fmt::format(", {} taxels saturated", glove.saturated_taxels);
  if (recorder.discarded_frames() > 0)
    text += fmt::format(", {} frames lost: the disk is too slow", recorder.discarded_frames());
  return text + fmt::format("; log {:.1f} MB", 1e-6 * static_cast<double>(recorder.log_bytes()));
}

/// Records until the time is over, all sources have ended, or Ctrl-C.
void record(Recorder& recorder, const GloveSource& glove, double seconds) {
  const double start_s = monotonic_s(), period_s = isatty(STDERR_FILENO) ? 1.0 : 10.0;
  double next_report_s = start_s + period_s;
  while (!interrupted() && recorder.step()) {
    const double now_s = monotonic_s();
    if (seconds > 0.0 && now_s - start_s >= seconds) break;
    if (now_s < next_report_s) continue;
    Progress::report(status_text(glove.status(), recorder));
    next_report_s += period_s;
  }
  recorder.finish();
  clear_interrupt();
}

void require_frames(const Recorder& recorder, const GloveStatus& glove,
                    const RecordOptions& options, const std::string& log) {
  if (recorder.written_frames() > 0) return;
  std::filesystem::remove(log);
  throw data_error(fmt::format("no frame arrived from {}", options.glove),
                   glove.counts.skipped_bytes > 0
                       ? "bytes arrived that are no frames: check --protocol, --baud, --rows, "
                         "--cols and --bits"
                       : "check that the glove is switched on, and --baud");
}

void print_summary(const nlohmann::json& summary, bool json) {
  if (json) return fmt::print("{}\n", summary.dump(2));
  fmt::print("{}: {} glove frames at {:.3f} Hz in {} clips, {:.1f} s\n",
             summary["output"].get<std::string>(), summary["glove_frames"].get<std::size_t>(),
             summary["rate_hz"].get<double>(), summary["clips"].get<std::size_t>(),
             summary["duration_s"].get<double>());
  fmt::print("{} dropped, {} torn, {} repeated, {} reconnections\n",
             summary["dropped"].get<std::size_t>(), summary["torn"].get<std::size_t>(),
             summary["repeated"].get<std::size_t>(), summary["reconnections"].get<std::size_t>());
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

ExitCode run(const RecordOptions& options, const Invocation& invocation) {
  if (options.glove.empty())
    throw usage_error("nothing to record", "give --glove PORT; `touchtrace doctor` lists ports");
  { const OutputFile writable(options.output, invocation.overwrite); }
  const GloveProtocol& protocol = find_glove_protocol(options.protocol);
  SessionInfo session = describe_session(options, invocation);
  session.glove = glove_info(options, protocol);
  GloveSource glove(protocol, *session.glove, {options.glove, options.baud, options.speed},
                    monotonic_s());
  const std::string log = options.output + ".log";
  Recorder recorder(log, session, {&glove});
  record(recorder, glove, options.seconds);
  require_frames(recorder, glove.status(), options, log);
  const LogConversion conversion = convert_log(log, options.output, invocation.overwrite);
  std::filesystem::remove(log);
  print_summary(summarize(options.output, conversion, glove.status(), recorder), invocation.json);
  return ExitCode::done;
}

}  // namespace

Command record_command() {
  return make_command<RecordOptions>(
      "record", "record a glove",
      {"touchtrace record --glove /dev/ttyACM0 --output my.h5",
       "touchtrace record --glove /dev/ttyUSB0 --protocol wiresens --seconds 60 --output my.h5",
       "touchtrace record --glove glove.bin --protocol stag --speed 0 --output my.h5"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
