#include <fmt/core.h>

#include "engine/train/tuner.h"
#include "engine/train/tuning_file.h"
#include "engine/train/tuning_json.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/study/model_options.h"

namespace touchtrace::cli {
namespace {

struct TuneOptions {
  study::ModelOptions model;
  int sequences = 8, steps = 20, object_segments = 32;
};

void describe(OptionSet& set, TuneOptions& o) {
  describe(set, o.model);
  set.group("Batches");
  set.integer("sequences", o.sequences, "roll-outs per batch", 1, 4096);
  set.integer("steps", o.steps, "steps per roll-out", 1, 200);
  set.integer("object-segments", o.object_segments,
              "segments per encoder update if the object encoder is frozen", 2, 1024);
}

ModelSpec spec_of(const study::ModelOptions& options) {
  if (options.without_touch)
    throw usage_error("a model without touch has nothing to tune", "leave --without-touch out");
  const auto [rows, cols] = image_shape(GloveInfo{}, options.resolution);
  return make_spec(options, rows, cols, options.object_encoder == "auto" ? 1 : 2);
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
  fmt::print("  {:<46} {:>9} {:>9}  {}\n", "", "default ms", "tuned ms", "choice");
  for (const auto& encoder : encoders) {
    const auto first = encoder.layers()[0];
    const auto& micro_batch = *tuning.micro_batch(first);
    print_row(fmt::format("{} windows of {} x {} x {}", first.images, first.in_channels, first.rows,
                          first.cols),
              micro_batch.times, fmt::format("micro-batches of {}", micro_batch.images));
    for (const auto& shape : encoder.of_windows(micro_batch.images).layers()) {
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

/// Tunings before and after the whole update was measured with the tuned kernels.
struct TuneResult {
  std::filesystem::path path;  ///< of the tuning file
  bool was_complete, stays;    ///< stays: the update is not slower than with the default variants
  Tuning measured, kept;
  TunedTimes update;
};

TuneResult tune_update(Runtime& runtime, const TuneOptions& options,
                       const std::vector<ConvStackShape>& encoders) {
  const auto path = writable_tuning_path();
  auto tuning = read_tuning(path, runtime.device());
  const bool was_complete = is_complete(tuning, encoders);
  const auto keep = [&] { write_tuning(path, runtime.device(), tuning); };
  if (!was_complete) {
    keep();  // fails now instead of after a minute if the file cannot be written
    tune(runtime, encoders, tuning, keep);
  }
  const auto update = measure_update_times(runtime, spec_of(options.model), options.sequences,
                                           options.steps, tuning);
  const bool stays = was_complete || is_faster(update);
  const auto measured = tuning;
  if (!stays) {
    reset_to_defaults(tuning, encoders);
    keep();
  }
  return {path, was_complete, stays, measured, tuning, update};
}

nlohmann::json result_json(const TuneResult& result, const std::string& device) {
  return {{"path", result.path.string()},
          {"device", device},
          {"was_complete", result.was_complete},
          {"stays", result.stays},
          {"tuning", result.kept},
          {"update", times_json(result.update)}};
}

ExitCode run(const TuneOptions& options, const Invocation& invocation) {
  Runtime runtime(usable_device(invocation.device));
  if (runtime.kernel_variant() == KernelVariant::gpu)
    throw usage_error("GPU kernels have no variants to tune",
                      "train without tuning, or choose a CPU with --device");
  const auto encoders = training_encoders(spec_of(options.model), options.sequences, options.steps,
                                          options.object_segments);
  const TuneResult result = tune_update(runtime, options, encoders);
  const auto& device = runtime.device().name;
  if (invocation.json) {
    fmt::print("{}\n", result_json(result, device).dump(2));
    return ExitCode::done;
  }
  fmt::print("{} on {}; tuning file {}\n", result.was_complete ? "tuned before" : "tuned", device,
             result.path.string());
  print_choices(result.measured, encoders);
  print_row("whole update", result.update, result.stays ? "" : "not faster: default variants kept");
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
