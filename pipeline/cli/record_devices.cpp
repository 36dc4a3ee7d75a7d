#include "pipeline/cli/record_devices.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/record/glove_config.h"

namespace touchtrace::cli {
namespace {

void apply_config(const std::string& path, const std::string& protocol, GloveInfo& info) {
  GloveConfig config = read_glove_config(path);
  if (config.protocol != protocol)
    throw data_error(fmt::format("{} is of a glove with protocol '{}', not '{}'", path,
                                 config.protocol, protocol),
                     fmt::format("give --protocol {}, or the file of this glove", config.protocol));
  info.rows = config.rows, info.cols = config.cols, info.bits = config.bits;
  info.polarity = config.polarity, info.rate_hz = config.rate_hz;
  info.baseline_counts = std::move(config.baseline_counts);
  for (const auto& fault : config.faults)
    Progress::warn(fmt::format("{}: not fit for use: {}", path, fault));
}

void apply_options(const DeviceOptions& options, GloveInfo& info) {
  if (options.rows > 0) info.rows = options.rows;
  if (options.cols > 0) info.cols = options.cols;
  if (options.bits > 0) info.bits = options.bits;
  if (options.rate_hz > 0.0) info.rate_hz = options.rate_hz;
  if (options.polarity != 0) info.polarity = options.polarity;
  if (!info.baseline_counts.empty() && std::ssize(info.baseline_counts) != info.taxels())
    throw usage_error(
        fmt::format("{} has a baseline of {} taxels, --rows and --cols say {} x {}",
                    options.glove_config, info.baseline_counts.size(), info.rows, info.cols),
        "leave out --rows and --cols, or learn the glove again");
}

}  // namespace

GloveInfo glove_info(const DeviceOptions& options) {
  const GloveProtocol& protocol = find_glove_protocol(options.protocol);
  GloveInfo info = protocol.usual_glove;
  info.name = protocol.name;
  if (!options.glove_config.empty()) apply_config(options.glove_config, protocol.name, info);
  apply_options(options, info);
  require_supported(protocol, info);
  return info;
}

std::unique_ptr<GloveSource> open_glove(const DeviceOptions& options, const GloveInfo& info,
                                        double start_s) {
  return std::make_unique<GloveSource>(
      find_glove_protocol(options.protocol), info,
      GloveSource::Options{options.glove, options.baud, options.speed}, start_s);
}

void require_glove_frames(const ParserCounts& glove, const std::string& port) {
  if (glove.frames > 0) return;
  throw data_error(
      fmt::format("no frame arrived from {}", port),
      glove.out_of_range > 0 ? "counts arrived that are larger than the converter's: check --bits, "
                               "or bits in the protocol's .toml"
      : glove.skipped_bytes > 0
          ? "bytes arrived that are no frames: check --protocol, --baud, --rows, --cols and --bits"
          : "check that the device is switched on, and --baud");
}

std::string glove_text(const GloveStatus& glove) {
  const ParserCounts& counts = glove.counts;
  std::string text =
      fmt::format("{:.3f} Hz, {} frames, {} dropped, {} torn, {} repeated", glove.rate_hz,
                  counts.frames, counts.dropped, counts.torn, counts.repeated);
  if (glove.saturated_taxels > 0)
    text += fmt::format(", {} taxels saturated", glove.saturated_taxels);
  if (10 * counts.out_of_range > counts.frames)
    text +=
        fmt::format(", {} packets with counts beyond the range: check --bits", counts.out_of_range);
  const double silence_s = monotonic_s() - glove.last_frame_s;
  if (!glove.is_connected)
    text += ", UNPLUGGED";
  else if (counts.frames > 0 && silence_s > 2.0)
    text += fmt::format(", nothing for {:.0f} s", silence_s);
  return text;
}

void describe_protocol(OptionSet& set, std::string& protocol) {
  set.text("protocol", protocol,
           fmt::format("serial protocol of the device: {}, or a file that describes it (.toml)",
                       fmt::join(glove_protocol_names(), ", ")))
      .value("PROTOCOL");
}

void describe_glove(OptionSet& set, DeviceOptions& o) {
  set.number("speed", o.speed, "of files, relative to the device; 0: no pauses", 0.0, 1e6);
  set.group("Glove");
  set.text("glove", o.glove, "serial port, usb:VENDOR:PRODUCT, or a file with the glove's bytes")
      .value("PORT");
  describe_protocol(set, o.protocol);
  set.integer("baud", o.baud, "bits per second; 0: the protocol's", 0, 12'000'000);
  set.integer("rows", o.rows, "rows of taxels; 0: the protocol's", 0, 255);
  set.integer("cols", o.cols, "columns of taxels; 0: the protocol's", 0, 255);
  set.integer("bits", o.bits, "of the converter; 0: the protocol's", 0, 16);
  set.integer("polarity", o.polarity,
              "1: counts increase with pressure, -1: they decrease; 0: the protocol's", -1, 1);
  set.number("rate-hz", o.rate_hz, "nominal frames per second; 0: the protocol's", 0.0, 1e4);
}

void describe_known_glove(OptionSet& set, DeviceOptions& o) {
  describe_glove(set, o);
  set.text("glove-config", o.glove_config,
           "file of `glove --learn`: layout, polarity and baseline, which then needs no rest")
      .value("FILE");
}

void describe(OptionSet& set, DeviceOptions& o) {
  describe_known_glove(set, o);
  describe_cameras(set, o);
}

std::vector<RecordSource*> Devices::sources() const {
  std::vector<RecordSource*> all;
  if (glove) all.push_back(glove.get());
  for (const auto& camera : cameras) all.push_back(camera.get());
  return all;
}

Devices open_devices(const DeviceOptions& options, SessionInfo& session) {
  const double start_s = monotonic_s();
  Devices devices{nullptr, open_cameras(options, start_s)};
  if (!devices.cameras.empty()) session.camera.emplace();
  for (const auto& camera : devices.cameras) camera->describe(*session.camera);
  if (!options.glove.empty()) {
    session.glove = glove_info(options);
    devices.glove = open_glove(options, *session.glove, start_s);
  }
  if (devices.sources().empty())
    throw usage_error("nothing to record",
                      "give --glove PORT (`touchtrace doctor` lists ports) or --camera SOURCE");
  return devices;
}

}  // namespace touchtrace::cli
