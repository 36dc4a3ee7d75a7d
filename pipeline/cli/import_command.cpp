#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/acquire/import/import.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct ImportCommandOptions {
  std::string source, output;
  ImportOptions import;
};

void describe(OptionSet& set, ImportCommandOptions& o) {
  set.optional_input(
      "source", o.source,
      "TUM RGB-D folder, folder with colour images (PNG, JPEG, ...) and depth images "
      "(PNG, TIFF, .npy, .mat), ROS 1 or 2 bag, or .npz with color, depth, time_s; "
      "none: the glove alone");
  set.path("output", o.output, "recording (.h5)").value("FILE");
  describe(set, o.import);
}

void print_images(const nlohmann::json& s, const std::string& output) {
  fmt::print(
      "{}: {} colour images of {} x {}, {} depth images of {} x {} at {:.2f} Hz, {} skipped\n",
      output, s["color_images"].get<std::size_t>(), s["width"].get<int>(), s["height"].get<int>(),
      s["depth_images"].get<std::size_t>(), s["depth_width"].get<int>(),
      s["depth_height"].get<int>(), s["rate_hz"].get<double>(), s["skipped"].get<std::size_t>());
  fmt::print("depth {}registered to colour, unit {:g} m; {} intrinsics; {} clips\n",
             s["registered"].get<bool>() ? "" : "not ", s["depth_unit_m"].get<double>(),
             s["intrinsics"].get<bool>() ? "with" : "no", s["clips"].get<std::size_t>());
}

void print_glove(const nlohmann::json& s, const std::string& output) {
  fmt::print("{}: {} glove frames of {} x {} taxels at {:.2f} Hz, {} bits, polarity {:+d}\n",
             output, s["frames"].get<std::size_t>(), s["rows"].get<int>(), s["cols"].get<int>(),
             s["rate_hz"].get<double>(), s["bits"].get<int>(), s["polarity"].get<int>());
}

void print_summary(const nlohmann::json& s, const std::string& output) {
  if (s.contains("color_images")) print_images(s, output);
  if (s.contains("glove")) print_glove(s["glove"], output);
}

/// Refuses options that would have no effect.
void require_used(const ImportCommandOptions& options) {
  const auto& import = options.import;
  const auto& glove = import.glove;
  if (options.source.empty() && glove.file.empty())
    throw usage_error("nothing to import", "give SOURCE with images, --glove FILE, or both");
  if (options.source.empty() && !(import.masks.empty() && import.camera.camera_info.empty()))
    throw usage_error("--masks and --camera-info need images", "give SOURCE, or leave them out");
  const bool has_layout =
      glove.layout.rows > 0 || glove.layout.cols > 0 || !glove.layout.stream.empty();
  if (glove.file.empty() && (has_layout || glove.bits > 0 || glove.polarity != 0))
    throw usage_error("options of a glove without --glove", "give --glove FILE, or leave them out");
}

ExitCode run(const ImportCommandOptions& options, const Invocation& invocation) {
  require_used(options);
  { const OutputFile writable(options.output, invocation.overwrite); }
  auto provenance = start_provenance("touchtrace/recording/2", "import");
  provenance.options = invocation.options;
  for (const auto& file : {options.source, options.import.glove.file})
    if (std::filesystem::is_regular_file(file)) provenance.add_input(file);
  const auto summary = import_recording(options.source, options.output, options.import, provenance,
                                        invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", summary.dump(2));
  else
    print_summary(summary, options.output);
  return ExitCode::done;
}

}  // namespace

Command import_command() {
  return make_command<ImportCommandOptions>(
      "import", "convert images, intrinsics and touch of other programs to a recording",
      {"touchtrace import rgbd_dataset_freiburg1_xyz --output my.h5",
       "touchtrace import my_images --rate 30 --camera-info camera_info.yaml --output my.h5",
       "touchtrace import my_images --glove recordings.hdf5 --output my.h5",
       "touchtrace import --glove touch.csv --polarity 1 --baseline 0 --output touch.h5",
       "touchtrace import camera.bag --depth-topic /camera/aligned_depth_to_color/image_raw "
       "--output my.h5"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
