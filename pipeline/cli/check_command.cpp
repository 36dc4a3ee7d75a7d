#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"
#include "pipeline/acquire/import/intrinsics.h"
#include "pipeline/cli/commands.h"
#include "pipeline/label/camera_calibration.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/intrinsics_check.h"

namespace touchtrace::cli {
namespace {

struct CheckOptions {
  std::string file, use = "anything", calibration;
  bool quick = false;
};

void describe(OptionSet& set, CheckOptions& o) {
  set.input("file", o.file, "recording or label file");
  set.choice("for", o.use, "command that must be able to use the file",
             {"anything", "calibrate", "label", "train"});
  set.text("calibration", o.calibration, "calibration for `label`: folder or file").value("PATH");
  set.flag("quick", o.quick, "do not decompress the images to test their checksums");
}

void print_stream(const std::string& name, const nlohmann::json& stream, const std::string& extra) {
  if (!std::isfinite(stream["rate_hz"].get<double>())) {
    fmt::print("{:<10} {} frames, too few for a rate{}\n", name,
               stream["frames"].get<std::size_t>(), extra);
    return;
  }
  fmt::print("{:<10} {} frames, {:.3f} Hz (nominal {:g}), {} lost ({:.2f} %), jitter {:.2f} ms{}\n",
             name, stream["frames"].get<std::size_t>(), stream["rate_hz"].get<double>(),
             stream["nominal_hz"].get<double>(), stream["lost"].get<std::size_t>(),
             100 * stream["lost_share"].get<double>(), 1e3 * stream["jitter_s"].get<double>(),
             extra);
}

std::string glove_details(const nlohmann::json& glove) {
  return fmt::format(
      "; {} x {}, {} bits, {} taxels ({} dead), frames all zero {:.2f} %, saturated {:.2f} %",
      glove["rows"].get<int>(), glove["cols"].get<int>(), glove["bits"].get<int>(),
      glove["taxels"].get<int>(), glove["dead_taxels"].get<int>(),
      100 * glove["zero_frames"].get<double>(), 100 * glove["saturated_frames"].get<double>());
}

std::string camera_details(const nlohmann::json& camera) {
  return fmt::format(
      "; {} x {}, {}, {} masks, {} background, {} board views", camera["width"].get<int>(),
      camera["height"].get<int>(), camera["depth"].get<bool>() ? "depth" : "no depth",
      camera["masks"].get<std::size_t>(), camera["background_frames"].get<std::size_t>(),
      camera["board_views"].get<std::size_t>());
}

void print_body(const std::string& name, const nlohmann::json& body) {
  fmt::print(
      "{:<10} lost {:.2f} %, moved with the hand {:.2f} %, outside the measured time {:.2f} %\n",
      name, 100 * body["lost_share"].get<double>(), 100 * body["follows_share"].get<double>(),
      100 * body["gap_share"].get<double>());
}

void print_holds(const nlohmann::json& holds) {
  const auto& clips = holds["clips"];
  fmt::print("{}, activity {}\n", holds["schema"].get<std::string>(),
             holds["activity"].get<std::string>());
  fmt::print("clips      {}, {:.1f} s, {} dropped; {}\n", clips["count"].get<std::size_t>(),
             clips["seconds"].get<double>(), clips["dropped"].get<std::size_t>(),
             clips["objects"].dump());
  if (holds.contains("labels")) {
    fmt::print("labels     {}, from {} camera frames\n", holds["labels"].get<std::size_t>(),
               holds["camera_frames"].get<std::size_t>());
    print_body("hand", holds["hand"]);
    print_body("object", holds["object"]);
    return;
  }
  for (const auto& glove : holds["gloves"]) {
    print_stream(glove["name"].get<std::string>(), glove, glove_details(glove));
    if (glove.contains("inertial")) print_stream("inertial", glove["inertial"], "");
  }
  print_stream("camera", holds["camera"], camera_details(holds["camera"]));
  fmt::print("truth      {}\n", holds["truth"].get<bool>() ? "yes" : "no");
}

void print_verdict(const FileCheck& check) {
  for (const auto& fault : check.faults) fmt::print("fault      {}\n", fault);
  for (const auto& warning : check.warnings) fmt::print("warning    {}\n", warning);
  for (const auto& [command, lacks] : check.missing) {
    if (lacks.empty()) fmt::print("{:<10} can use it\n", command);
    for (const auto& lack : lacks) fmt::print("{:<10} cannot use it: {}\n", command, lack);
  }
}

/// Adds a calibration that `label` cannot use to what it misses.
void check_calibration(const CheckOptions& options, FileCheck& check) {
  const auto label = check.missing.find("label");
  if (options.calibration.empty() || label == check.missing.end()) return;
  const RecordingReader reader(options.file);
  const CameraInfo& camera = reader.recording().camera;
  const auto calibration = read_intrinsics(options.calibration, camera.width, camera.height);
  if (const auto fault = implausible_intrinsics(calibration.color); !fault.empty())
    check.warnings.push_back("intrinsics of --calibration: " + fault);
  try {
    label::camera_calibration(calibration, camera);
  } catch (const Error& error) {
    label->second.emplace_back(error.what());
  }
}

/// A file that cannot be read has faults and nothing else.
FileCheck check_readable(const CheckOptions& options, bool as_json) {
  try {
    return check_file(options.file, !options.quick, !options.calibration.empty());
  } catch (const Error& error) {
    FileCheck faulty;
    faulty.faults = {error.what()};
    if (as_json && error.code() == ExitCode::data) fmt::print("{}\n", to_json(faulty).dump(2));
    throw;
  }
}

ExitCode run(const CheckOptions& options, const Invocation& invocation) {
  FileCheck check = check_readable(options, invocation.json);
  check_calibration(options, check);
  if (invocation.json) {
    fmt::print("{}\n", to_json(check).dump(2));
  } else {
    print_holds(check.contents);
    print_verdict(check);
  }
  const auto wanted = check.missing.find(options.use);
  const bool is_usable =
      options.use == "anything" || (wanted != check.missing.end() && wanted->second.empty());
  return check.is_usable() && is_usable ? ExitCode::done : ExitCode::data;
}

}  // namespace

Command check_command() {
  return make_command<CheckOptions>(
      "check", "describe a recording or label file and test whether commands can use it",
      {"touchtrace check wave.h5",
       "touchtrace check wave.h5 --for label --calibration camera --json"},
      run, {.quiet = true});
}

}  // namespace touchtrace::cli
