#include <fmt/core.h>

#include "engine/base/text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/export/export.h"

namespace touchtrace::cli {
namespace {

struct ExportOptions {
  std::string input, format, output, recording;
  bool images = false;
};

std::string format_help() {
  std::string help;
  for (const ExportFormat& format : export_formats())
    help += fmt::format("{}{}: {}", help.empty() ? "" : "; ", format.name, format.description);
  return help;
}

void describe(OptionSet& set, ExportOptions& o) {
  set.input("input", o.input,
            "labels, recording, JSON lines of `predict`, or model; recognised by the content");
  set.path("format", o.format, format_help()).value("FORMAT");
  set.path("output", o.output, "file, or folder of several files").value("OUT");
  set.text(
         "recording", o.recording,
         "recording of the labels or predictions: their Unix time; in mcap and rosbag2 also touch")
      .value("FILE");
  set.flag("images", o.images, "mcap and rosbag2: with the camera's images");
}

ExitCode run(const ExportOptions& options, const Invocation& invocation) {
  const FileKind kind = recognize_file(options.input);
  const auto files =
      export_file(options.format, {kind, options.input, options.output, options.recording,
                                   options.images, invocation.overwrite});
  nlohmann::json names;
  for (const auto& file : files) names.push_back(file.string());
  if (invocation.json)
    fmt::print("{}\n", nlohmann::json{{"files", names}}.dump(2));
  else
    for (const auto& file : files) fmt::print("wrote {}\n", file.string());
  return ExitCode::done;
}

}  // namespace

Command export_command() {
  return make_command<ExportOptions>(
      "export", "write labels, touch, predictions or a model in the format of another program",
      {"touchtrace export my.labels.h5 --format csv --output my.csv",
       "touchtrace export my.labels.h5 --format mcap --recording my.h5 --images --output my.mcap",
       "touchtrace export my.h5 --format npz --output touch.npz",
       "touchtrace export full.safetensors --format onnx --output full.onnx"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
