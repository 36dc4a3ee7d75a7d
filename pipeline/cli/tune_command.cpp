#include <fmt/core.h>

#include "engine/train/tuner.h"
#include "engine/train/tuning_file.h"
#include "engine/train/tuning_json.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/study/convolution_options.h"
#include "pipeline/study/plan.h"

namespace touchtrace::cli {
namespace {

struct TuneOptions {
  int window = 10, resolution = 32, sequences = 8, steps = 20, object_segments = 32;
  study::ConvolutionOptions convolutions;
  std::string object_encoder = "none";
};

void describe(OptionSet& set, TuneOptions& o) {
  set.group("Model");
  set.integer("window", o.window, "tactile frames per window, 1-32", 1, 32);
  set.integer("resolution", o.resolution, "tactile rows and columns, 6-64", 6, 64);
  describe(set, o.convolutions);
  set.choice("object-encoder", o.object_encoder, "object encoder of the model",
             {"none", "frozen", "joint"});
  set.group("Batches");
  set.integer("sequences", o.sequences, "roll-outs per batch", 1, 4096);
  set.integer("steps", o.steps, "steps per roll-out", 1, 200);
  set.integer("object-segments", o.object_segments,
              "segments per encoder update if the object encoder is frozen", 2, 1024);
}

ModelSpec spec_of(const TuneOptions& options) {
  return study::make_plan({.objects = {"one", "another"},
                           .object_encoder = options.object_encoder,
                           .window_frames = options.window,
                           .rows = options.resolution,
                           .cols = options.resolution,
                           .tactile_kernel = options.convolutions.kernel_size(),
                           .tactile_strides = options.convolutions.stride_sizes()})
      .model;
}

std::filesystem::path writable_tuning_path() {
  const auto path = tuning_path();
  if (path.empty())
    throw usage_error("no folder for the tuning file",
                      "set HOME, or XDG_CACHE_HOME to an absolute path");
  return path;
}

void print_row(const std::string& what, const TunedTimes& times, const std::string& choice) {
  fmt::print("  {:<46} {:>9.3f} {:>9.3f}  {}\n", what, times.default_ms, times.tuned_ms, choice);
}

/// Prints the variants chosen, per encoder.
void print_choices(const Tuning& tuning, const std::vector<ConvStackShape>& encoders) {
  fmt::print("  {:<46} {:>9} {:>9}  {}\n", "", "default ms", "chosen ms", "choice");
  for (const auto& encoder : encoders) {
    const auto first = encoder.layers()[0];
    const auto& part = *tuning.micro_batch(first);
    print_row(fmt::format("{} windows of {} x {} x {}", first.images, first.in_channels, first.rows,
                          first.cols),
              part.times, fmt::format("parts of {}", part.images));
    for (const auto& shape : encoder.of_windows(part.images).layers()) {
      const auto& layer = *tuning.layer(shape);
      print_row(fmt::format("  {} x {} x {} x {} to {} channels, {} x {} by {}", shape.images,
                            shape.in_channels, shape.rows, shape.cols, shape.out_channels,
                            shape.kernel, shape.kernel, shape.stride),
                layer.times, describe(layer.choice));
    }
  }
}

nlohmann::json times_json(const TunedTimes& times) {
  return {{"default_ms", times.default_ms}, {"tuned_ms", times.tuned_ms}};
}

ExitCode run(const TuneOptions& options, const Invocation& invocation) {
  Runtime runtime(usable_device(invocation.device));
  const auto path = writable_tuning_path();
  const auto spec = spec_of(options);
  const auto encoders =
      training_encoders(spec, options.sequences, options.steps, options.object_segments);
  auto tuning = read_tuning(path, runtime.device());
  const bool was_complete = is_complete(tuning, encoders);
  const auto keep = [&] { write_tuning(path, runtime.device(), tuning); };
  if (!was_complete) {
    keep();  // fails now instead of after a minute if the file cannot be written
    tune(runtime, encoders, tuning, keep);
  }
  const auto update = measure_update_times(runtime, spec, options.sequences, options.steps, tuning);
  const bool stays = was_complete || is_faster(update);
  const auto measured = tuning;
  if (!stays) {
    reset_to_defaults(tuning, encoders);
    keep();
  }
  if (invocation.json) {
    fmt::print("{}\n", nlohmann::json{{"path", path.string()},
                                      {"device", runtime.device().name},
                                      {"was_complete", was_complete},
                                      {"stays", stays},
                                      {"tuning", tuning},
                                      {"update", times_json(update)}}
                           .dump(2));
    return ExitCode::done;
  }
  fmt::print("{} on {}; tuning file {}\n", was_complete ? "tuned before" : "tuned",
             runtime.device().name, path.string());
  print_choices(measured, encoders);
  print_row("whole update", update, stays ? "" : "not faster: default variants kept");
  return ExitCode::done;
}

}  // namespace

Command tune_command() {
  return make_command<TuneOptions>(
      "tune", "measure the fastest kernel variants for a model on a device, for `train`",
      {"touchtrace tune", "touchtrace tune --sequences 32 --object-encoder joint --json"}, run,
      {.device = true, .quiet = true});
}

}  // namespace touchtrace::cli
