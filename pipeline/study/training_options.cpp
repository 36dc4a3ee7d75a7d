#include <limits>

#include "pipeline/study/training.h"

namespace touchtrace::study {

void describe(OptionSet& set, TrainingOptions& o) {
  set.paths("recording", o.recordings, "recordings to learn from");
  set.paths("labels", o.labels, "their labels, in the same order");
  set.path("output", o.output, "model file to write (safetensors)");
  set.flag("without-touch", o.without_touch, "train the baseline that sees no tactile frame");
  set.flag("resume", o.resume, "go on from the checkpoint beside the output");
  set.choice("object-encoder", o.object_encoder,
             "what tells the model which object is in hand; auto: nothing for one object, frozen "
             "embeddings for several",
             {"auto", "none", "frozen", "joint"});
  set.integer("object-updates", o.objects.updates,
              "updates of the object encoder before its embeddings are frozen", 1, 1'000'000);
  set.integer("object-segments", o.objects.segments, "touch segments in a batch of these updates",
              2, 1024);
  set.number("object-loss", o.optimizer.object_loss,
             "weight of the contrastive loss where the object encoder is trained along", 0.0, 1e3);
  set.number("contrast-temperature", o.contrast_temperature,
             "of the contrastive loss between normalised embeddings; 0: between dot products", 0.0,
             100.0);
  set.number("band-quantile", o.band_quantile,
             "Q of the predicted band, which holds a share 1 - 2 Q of the states", 0.001, 0.499);
  set.choice("dynamics", o.dynamics,
             "what predicts the next state: the paper's MLP, or a GRU that remembers",
             {"mlp", "gru"});
  set.choice("activation", o.activation, "between the layers of the dynamics MLP",
             {"relu", "silu", "tanh"});
  set.integer("updates", o.optimizer.updates, "updates of the weights", 1, 10'000'000);
  set.integer("window", o.window, "tactile frames in a window, M", 1, 32);
  set.integer("resolution", o.resolution, "rows and columns of a tactile frame", 6, 64);
  describe(set, o.convolutions);
  set.integer("sequences", o.sequences, "roll-outs in a batch", 1, 4096);
  set.integer("steps", o.steps, "steps of a roll-out in training", 1, 200);
  set.number("learning-rate", o.optimizer.learning_rate,
             "at the start; falls to 0 by a half cosine", 1e-8, 1.0);
  set.number("weight-decay", o.optimizer.weight_decay, "decoupled, of AdamW", 0.0, 10.0);
  set.number("clip-norm", o.optimizer.clip_norm, "largest norm of a gradient", 1e-6, 1e6);
  set.number("taxel-dropout", o.optimizer.taxel_dropout, "share of taxels blanked in an update",
             0.0, 0.9);
  set.integer(
      "skip-not-finite", o.optimizer.max_consecutive_skips,
      "updates in a row that may be left out since loss or gradient are not finite; 0: stop "
      "at the first",
      0, 1000);
  set.choice("accuracy", o.accuracy,
             "fast flushes denormals; exact does not, and compensates long sums",
             {"fast", "exact"});
  set.number("checkpoint-seconds", o.checkpoint_s, "between checkpoints, in s", 0.0, 1e6);
  set.seed("seed", o.optimizer.seed, "of the weights, the batches and the drop-out");
}

}  // namespace touchtrace::study
