#include "pipeline/study/training.h"

namespace touchtrace::study {
namespace {

void describe_files(OptionSet& set, TrainingOptions& o) {
  set.group("Files");
  set.paths("recording", o.recordings, "training recordings, or folders of them").value("FILE");
  set.texts("labels", o.labels, "label files, in the same order; default: X.labels.h5 of X.h5")
      .value("FILE");
  set.path("output", o.output, "model (.safetensors)").value("FILE");
  set.flag("resume", o.resume, "continue from OUTPUT.checkpoint");
  set.number("checkpoint-seconds", o.checkpoint_s, "time between checkpoints", 0.0, 1e6)
      .value("SECONDS");
}

void describe_model(OptionSet& set, TrainingOptions& o) {
  describe(set, o.model);
  set.choice("activation", o.activation, "MLP activation", {"relu", "silu", "tanh"});
  set.number("band-quantile", o.band_quantile, "predict quantiles Q and 1-Q", 0.001, 0.499)
      .value("Q");
}

void describe_object_encoder(OptionSet& set, TrainingOptions& o) {
  set.group("Object encoder");
  set.integer("object-updates", o.objects.updates, "encoder updates before freezing", 1, 1'000'000);
  set.integer("object-segments", o.objects.segments, "segments per encoder update", 2, 1024);
  set.number("object-loss", o.optimizer.object_loss, "contrastive loss weight if joint", 0.0, 1e3);
  set.number("contrast-temperature", o.contrast_temperature,
             "contrastive loss of cosines / T; 0: of dot products", 0.0, 100.0)
      .value("T");
}

void describe_optimisation(OptionSet& set, TrainingOptions& o) {
  set.group("Optimisation");
  set.integer("updates", o.optimizer.updates, "weight updates", 1, 10'000'000);
  set.integer("sequences", o.sequences, "roll-outs per batch", 1, 4096);
  set.integer("steps", o.steps, "steps per roll-out", 1, 200);
  set.number("learning-rate", o.optimizer.learning_rate, "initial; cosine decay to 0", 1e-8, 1.0);
  set.number("weight-decay", o.optimizer.weight_decay, "AdamW weight decay", 0.0, 10.0);
  set.number("clip-norm", o.optimizer.clip_norm, "maximum gradient norm", 1e-6, 1e6);
  set.number("taxel-dropout", o.optimizer.taxel_dropout, "fraction of taxels zeroed", 0.0, 0.9)
      .value("P");
  set.integer("skip-not-finite", o.optimizer.max_consecutive_skips,
              "consecutive updates with NaN or infinity to skip; 0: stop at the first", 0, 1000);
  set.choice("accuracy", o.accuracy, "exact: denormals, compensated sums, no Winograd",
             {"fast", "exact"});
  set.seed("seed", o.optimizer.seed, "weights, batches, dropout");
}

}  // namespace

void describe(OptionSet& set, TrainingOptions& o) {
  describe_files(set, o);
  describe_model(set, o);
  describe_object_encoder(set, o);
  describe_optimisation(set, o);
}

}  // namespace touchtrace::study
