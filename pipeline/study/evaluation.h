#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "pipeline/study/comparison.h"

namespace touchtrace::study {

/// Options of `touchtrace evaluate`.
struct EvaluationOptions {
  std::vector<std::string> recordings, labels;  ///< pairs, in the same order
  std::vector<std::string> models;
  std::string output, accuracy = "fast";
  std::string against = "auto";  ///< "truth", "labels", or "auto": truth if all recordings have it
  int stride = 5;                ///< frames between starts
  std::uint64_t seed = 1;
};

void describe(OptionSet& set, EvaluationOptions& options);

/// Throws data_error for a file that `touchtrace train` did not write.
LoadedModel load_model(Runtime& runtime, const std::string& path);

/// Compares all models, and baselines that need none, on the evaluation clips of the sessions of
/// their activity (evaluation_clips.h). Returns
///   results: rows {activity, object, split, model, kind, runs, clips, rollouts, l1_at_50, ...} of
///     each group of models that differ in their seed only, with intervals
///   runs: the same metrics for each model file
///   differences: each full model minus without_touch, without_embedding and hold, with intervals
///   curves: L1 and coverage by step
///   examples: some roll-outs with their tactile frames, for the report
///   models: their cards
///   label_errors: errors of the labels relative to the truth, and its offset, if any
///   against: "truth" or "labels", the reference of `results`
///   scaling: by activity mean, deviation and the model that they are from
///   notes: what a reader of the results has to know
/// Throws data_error if a model has no session of its activity, a glove's rate differs from that of
/// the training, or the evaluation clips are seen by a model, too few or too short.
nlohmann::json evaluate_models(std::vector<Session> sessions, std::vector<LoadedModel>& models,
                               const EvaluationOptions& options);

}  // namespace touchtrace::study
