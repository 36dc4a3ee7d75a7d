#include <fmt/core.h>

#include <filesystem>

#include "engine/base/scratch_folder.h"
#include "pipeline/study/evaluation.h"
#include "pipeline/study/training.h"
#include "tests/verify/study/synthetic.h"
#include "tests/verify/verifications.h"

namespace touchtrace::study {
namespace {

namespace fs = std::filesystem;

constexpr int updates = 400, window_frames = 4;

LoadedModel train(Runtime& runtime, const Dataset& data, const fs::path& output, bool touch) {
  TrainingOptions options;
  options.output = output.string();
  options.model.without_touch = !touch;
  options.model.window = window_frames;
  options.optimizer.updates = updates;
  Provenance provenance = start_provenance("touchtrace/model/1", "verify");
  provenance.options = nlohmann::json::object();
  train_model(runtime, data, options, std::move(provenance), true);
  return load_model(runtime, options.output);
}

double value(const Comparison& comparison, const char* model, const char* metric) {
  const auto [object, which] = comparison.objects().front();
  return summary(comparison.find(model)->runs.front().scores.front(), which).at(metric);
}

double coverage(const Comparison& comparison, bool scaled) {
  const auto [object, which] = comparison.objects().front();
  return nan_mean(
      coverage_of(comparison.find("full")->runs.front(), comparison.cases(), which, scaled));
}

void measure(const std::function<void(Figure)>& emit) {
  const ScratchFolder folder;
  Runtime runtime(choose_device(""));
  const Session session{"synthetic", synthetic_dataset({40}), {}};
  LoadedModel full = train(runtime, session.data, folder.path() / "full", true);
  LoadedModel without = train(runtime, session.data, folder.path() / "without_touch", false);
  const Comparison comparison =
      compare_models({&session}, {&full, &without}, Reference::truth, 5, 1);
  for (const char* metric : {"l1_at_20", "l1_at_50"}) {
    const double random = value(comparison, "random", metric),
                 blind = value(comparison, "without_touch", metric);
    emit(at_most(fmt::format("full over without_touch, {}", metric),
                 value(comparison, "full", metric) / blind, "1", 0.8));
    emit(at_most(fmt::format("without_touch over random, {}", metric), blind / random, "1", 0.95));
  }
  emit(within("coverage of the scaled band over 50 steps", coverage(comparison, true), "1", 0.72,
              0.88));
  emit(reported("coverage of the band as predicted", coverage(comparison, false), "1"));
}

}  // namespace

Verification verify_study() { return measure; }

}  // namespace touchtrace::study
