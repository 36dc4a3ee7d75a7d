#include "pipeline/study/training.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/file_lock.h"
#include "engine/base/files.h"
#include "engine/base/integer_math.h"
#include "engine/base/progress.h"
#include "engine/train/object_embedder.h"
#include "engine/train/safetensors.h"
#include "pipeline/study/object_training.h"
#include "pipeline/study/sampler.h"
#include "pipeline/study/training_files.h"
#include "pipeline/study/validation.h"

namespace touchtrace::study {
namespace {

constexpr int validations_per_run = 20;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Options and input hashes that a resumed run must share with its checkpoint.
nlohmann::json identity(const Provenance& provenance) {
  nlohmann::json same{{"options", provenance.options}, {"inputs", nlohmann::json::array()}};
  for (const char* option :
       {"resume", "checkpoint_seconds", "skip_not_finite", "recording", "labels", "output"})
    same["options"].erase(option);
  for (const auto& input : provenance.inputs) same["inputs"].push_back(input.sha256);
  return same;
}

ModelCard make_card(const Dataset& data, const TrainingOptions& options, Provenance provenance) {
  ModelCard card;
  card.objects = training_objects(data);
  card.spec = make_spec(options.model, data.rows, data.cols, card.objects.size());
  card.spec.contrast_temperature = static_cast<float>(options.contrast_temperature);
  card.spec.band_quantile = options.band_quantile;
  card.spec.activation = activation_of(options.activation);
  card.scaling = fit_normalization(data);
  for (const Sequence& clip : data.sequences)
    if (clip.split != Split::evaluation)
      std::ranges::copy(clip.fingerprints, std::back_inserter(card.seen_clips));
  std::ranges::sort(card.seen_clips);
  card.activity = data.activity;
  card.rate_hz = data.rate_hz;
  card.warnings = data.warnings;
  card.provenance = std::move(provenance);
  return card;
}

class TrainingRun {
 public:
  TrainingRun(Runtime& runtime, const Dataset& data, const TrainingOptions& options, ModelCard card)
      : runtime_(runtime),
        data_(data),
        options_(options),
        lock_(options.output),
        checkpoint_(options.output),
        card_(std::move(card)),
        sampler_(data, card_.scaling, card_.spec, options.sequences, options.steps,
                 options.optimizer.seed),
        validation_(runtime, data, card_),
        trainer_(runtime, card_.spec, options.optimizer, options.sequences, options.steps,
                 options.model.without_touch ? std::span<const float>()
                                             : std::span<const float>(data.tactile)) {}

  ModelCard run(bool overwrite) {
    prepare(overwrite);
    if (card_.spec.object == ObjectEncoder::frozen)
      trainer_.freeze_objects(freeze_objects(runtime_, data_, card_.spec, object_encoder()));
    try {
      train();
    } catch (const Error& error) {
      if (error.code() == ExitCode::interrupted) stop_interrupted();
      if (error.code() == ExitCode::failed) save_checkpoint();  // before an update that failed
      if (checkpoint_.exists())
        throw Error(error.code(), error.what(),
                    fmt::format("{}; --resume continues from the checkpoint {}", error.hint(),
                                checkpoint_.path().string()));
      throw;
    }
    return finish(overwrite);
  }

 private:
  int updates() const { return options_.optimizer.updates; }

  [[noreturn]] void stop_interrupted() {
    save_checkpoint();
    throw Error(ExitCode::interrupted,
                fmt::format("interrupted after {} updates", trainer_.updates()),
                "run the same command with --resume to continue");
  }

  void prepare(bool overwrite) {
    // These fail before the training, not after it.
    OutputFile(options_.output, overwrite);
    if (card_.spec.object != ObjectEncoder::none)
      SegmentSampler(data_, card_.spec.segment_frames, 1, options_.optimizer.seed);
    if (options_.resume)
      position_ = checkpoint_.load(trainer_, identity(card_.provenance));
    else if (checkpoint_.exists() && !overwrite)
      throw usage_error(fmt::format("{} has a checkpoint of an unfinished run", options_.output),
                        "use --resume to continue it, or --overwrite to start again");
  }

  std::vector<Tensor> object_encoder() const {
    if (options_.resume) return object_encoder_of(read_safetensors(checkpoint_.path()));
    return train_object_encoder(runtime_, data_, card_.spec, options_.optimizer, options_.objects);
  }

  void train() {
    Progress progress("training", static_cast<std::uint64_t>(updates() - trainer_.updates()));
    while (trainer_.updates() < updates()) {
      const double loss = update();
      if (is_validation_due()) validate();
      if (seconds_since(saved_) >= options_.checkpoint_s) save_checkpoint();
      progress.advance(1, fmt::format("loss {:.3f}", loss));
    }
  }

  double update() {
    const auto start = Clock::now();
    const double loss = trainer_.update(sampler_.batch(trainer_.updates()));
    position_.seconds += seconds_since(start);
    if (!std::isfinite(loss)) return loss;  // skipped update
    position_.loss_sum += loss;
    ++position_.loss_count;
    return loss;
  }

  bool is_validation_due() const {
    const int period = ceil_div(updates(), validations_per_run);
    return !validation_.empty() &&
           (trainer_.updates() % period == 0 || trainer_.updates() == updates());
  }

  /// Validates the current weights and keeps them if they are the best so far.
  void validate() {
    TrainingLogEntry entry{trainer_.updates(), position_.seconds,
                           position_.loss_sum / std::max(position_.loss_count, 1)};
    TensorFile model = trainer_.model_file(card_);
    validation_.evaluate(model, entry);
    position_.log.push_back(entry);
    if (best_entry(position_.log).update == entry.update) position_.best = std::move(model.tensors);
    position_.loss_sum = 0.0;
    position_.loss_count = 0;
  }

  void save_checkpoint() {
    checkpoint_.save(trainer_, position_, identity(card_.provenance));
    saved_ = Clock::now();
  }

  ModelCard finish(bool overwrite) {
    TensorFile file = trainer_.model_file(card_);
    if (!position_.log.empty()) file.tensors = position_.best;
    card_.log = position_.log;
    card_.update = position_.log.empty() ? updates() : best_entry(position_.log).update;
    card_.band_scale = validation_.band_scale(file);
    watch_.stop(card_.provenance);
    if (card_.spec.object != ObjectEncoder::none)
      card_.mean_embedding =
          mean_training_embedding(runtime_, data_, card_.spec, object_encoder_of(file));
    file.metadata["metadata"] = nlohmann::json(card_).dump();
    write_safetensors(options_.output, file, overwrite);
    checkpoint_.remove();
    return card_;
  }

  Runtime& runtime_;
  const Dataset& data_;
  TrainingOptions options_;
  FileLock lock_;
  Checkpoint checkpoint_;
  ModelCard card_;
  Stopwatch watch_;
  Sampler sampler_;
  Validation validation_;
  Trainer trainer_;
  TrainingPosition position_;
  Clock::time_point saved_ = Clock::now();
};

}  // namespace

ModelCard train_model(Runtime& runtime, const Dataset& data, const TrainingOptions& options,
                      Provenance provenance, bool overwrite) {
  provenance.device = runtime.device().name;
  provenance.seed = options.optimizer.seed;
  return TrainingRun(runtime, data, options, make_card(data, options, std::move(provenance)))
      .run(overwrite);
}

}  // namespace touchtrace::study
