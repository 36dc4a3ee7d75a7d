#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "engine/cl/runtime.h"
#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/model_options.h"
#include "pipeline/study/object_training.h"

namespace touchtrace::study {

/// Options of `touchtrace train`.
struct TrainingOptions {
  std::vector<std::string> recordings, labels;  ///< pairs, in the same order
  std::string output, accuracy = "fast";
  bool resume = false;
  ModelOptions model;
  int sequences = 8, steps = 20;
  double contrast_temperature = 0.0;
  double band_quantile = 0.1;
  std::string activation = "relu";
  ObjectTraining objects;
  double checkpoint_s = 30.0;  ///< between checkpoints
  TrainOptions optimizer;
};

void describe(OptionSet& set, TrainingOptions& options);

/// Trains on the training clips of `data` and writes `options.output`: the weights with the best
/// L1@50 on the validation clips, of 20 validations, or the last ones without validation clips.
/// With frozen object embeddings the object encoder is trained first. A checkpoint is kept next to
/// the output; with `options.resume` training continues from it, bit-identical to an uninterrupted
/// run. Ctrl-C saves a checkpoint and throws. `provenance` is completed and stored in the model
/// card. Throws data_error if no training clip is long enough.
ModelCard train_model(Runtime& runtime, const Dataset& data, const TrainingOptions& options,
                      Provenance provenance, bool overwrite);

}  // namespace touchtrace::study
