#include <fmt/core.h>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/learn_glove.h"
#include "pipeline/acquire/record/glove_config.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/record_devices.h"

namespace touchtrace::cli {
namespace {

constexpr double pause_s = 1.0;  // between rest and squeezing

struct GloveOptions {
  bool learn = false;
  double seconds = 10.0;
  std::string output;
  DeviceOptions devices;
};

void describe(OptionSet& set, GloveOptions& o) {
  set.flag("learn", o.learn,
           "find polarity, baseline, noise and defects: leave the glove at rest, then squeeze it");
  set.number("seconds", o.seconds, "duration of each part [s]", 1.0, 600.0);
  set.text("output", o.output, "JSON for --glove-config of `record` and `predict`").value("FILE");
  describe_glove(set, o.devices);
}

/// Frames of both parts, one after the other.
struct Frames {
  std::vector<std::uint16_t> rest, squeezed;
};

/// Collects frames by the times of their arrival.
class FrameCollector {
 public:
  FrameCollector(std::size_t taxels, double seconds) : taxels_(taxels), seconds_(seconds) {}

  void add(RecordKind kind, const std::vector<std::uint8_t>& payload) {
    FrameStamp stamp;
    if (kind != RecordKind::glove_frame || !from_payload(payload, taxels_, stamp, counts_)) return;
    if (first_s_ < 0.0) first_s_ = stamp.host_time_s;
    time_s_ = stamp.host_time_s - first_s_;
    if (time_s_ < seconds_)
      frames_.rest.insert(frames_.rest.end(), counts_.begin(), counts_.end());
    else if (time_s_ >= seconds_ + pause_s)
      frames_.squeezed.insert(frames_.squeezed.end(), counts_.begin(), counts_.end());
  }
  bool is_rest_over() const { return time_s_ >= seconds_; }
  bool is_finished() const { return time_s_ >= 2.0 * seconds_ + pause_s; }
  const Frames& frames() const { return frames_; }

 private:
  std::size_t taxels_;
  double seconds_, first_s_ = -1.0, time_s_ = 0.0;
  std::vector<std::uint16_t> counts_;
  Frames frames_;
};

/// Stops early if the source ends, or if the device is silent.
Frames collect(GloveSource& glove, std::size_t taxels, double seconds) {
  FrameCollector collector(taxels, seconds);
  const RecordSink sink = [&](RecordKind kind, const std::vector<std::uint8_t>& payload) {
    collector.add(kind, payload);
  };
  Progress::report(fmt::format("leave the glove at rest for {:.0f} s", seconds));
  const double end_s = monotonic_s() + 3.0 * (seconds + pause_s);
  bool was_rest_over = false;
  while (!collector.is_finished() && monotonic_s() < end_s && glove.step(sink)) {
    throw_if_interrupted();
    if (collector.is_rest_over() && !std::exchange(was_rest_over, true))
      Progress::report(fmt::format("now squeeze it again and again for {:.0f} s", seconds));
  }
  return collector.frames();
}

void print(const LearnedGlove& glove, const std::string& output) {
  fmt::print("polarity {:+d}, baseline {:.0f} counts (median), noise {:.1f} counts\n",
             glove.polarity, glove.median_baseline, glove.noise_counts);
  fmt::print("{} taxels, {} do not respond, {} stuck, {:.0f} % repeated frames\n", glove.taxels,
             glove.dead_taxels, glove.stuck_taxels, 100.0 * glove.repeated_frames);
  for (const auto& fault : glove.faults()) fmt::print("not fit for use: {}\n", fault);
  if (!glove.faults().empty()) return;
  if (output.empty())
    fmt::print("fit for use: record with --polarity {}\n", glove.polarity);
  else
    fmt::print("fit for use: record with --glove-config {}\n", output);
}

ExitCode run(const GloveOptions& options, const Invocation& invocation) {
  if (!options.learn || options.devices.glove.empty())
    throw usage_error("nothing to do without --learn", "give --learn --glove PORT");
  if (!options.output.empty()) OutputFile(options.output, invocation.overwrite);
  SessionInfo session;
  const Devices devices = open_devices(options.devices, session);
  const Frames frames =
      collect(*devices.glove, static_cast<std::size_t>(session.glove->taxels()), options.seconds);
  require_glove_frames(devices.glove->status().counts, options.devices.glove);
  const LearnedGlove learned = learn_glove(*session.glove, frames.rest, frames.squeezed);
  const nlohmann::json config = glove_config_json(session.glove->name, *session.glove, learned);
  if (!options.output.empty()) write_file(options.output, config.dump(2), invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", config.dump(2));
  else
    print(learned, options.output);
  return learned.faults().empty() ? ExitCode::done : ExitCode::data;
}

}  // namespace

Command glove_command() {
  return make_command<GloveOptions>(
      "glove", "check a glove and find its polarity",
      {"touchtrace glove --learn --glove /dev/ttyACM0 --output glove.json",
       "touchtrace glove --learn --glove glove.bin --protocol stag"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
