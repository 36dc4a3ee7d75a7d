#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "engine/cl/runtime.h"
#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/study/convolution_options.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/objects.h"

namespace touchtrace::study {

/// Options of `touchtrace train`. The defaults are the recipe under which touch counts.
struct TrainingOptions {
  std::vector<std::string> recordings, labels;  ///< pairs, in the same order
  std::string output, accuracy = "fast";
  bool without_touch = false, resume = false;
  int window = 10, resolution = 32;
  ConvolutionOptions convolutions;
  int sequences = 8, steps = 20;
  std::string object_encoder = "auto";  ///< "none", "frozen", "joint"; "auto": what plan.h chooses
  double contrast_temperature = 0.0;
  double band_quantile = 0.1;
  std::string activation = "relu", dynamics = "mlp";
  ObjectTraining objects;
  double checkpoint_s = 30.0;  ///< between checkpoints
  TrainOptions optimizer;
};

void describe(OptionSet& set, TrainingOptions& options);

/// Trains on the training clips of `data` (before that an object encoder, whose embeddings then
/// stay, if the plan says so), looking at its validation clips 20 times, and writes the
/// weights that did best on them (L1@50; the last ones without validation clips) to
/// `options.output`. A checkpoint lies beside it meanwhile; with `options.resume` training goes on
/// from there, to the same bits as without the break. Ctrl-C saves a checkpoint and throws.
/// `provenance` is finished and put into the model's card. Throws data_error if no training clip is
/// long enough.
ModelCard train_model(Runtime& runtime, const Dataset& data, const TrainingOptions& options,
                      Provenance provenance, bool overwrite);

}  // namespace touchtrace::study
