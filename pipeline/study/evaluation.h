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

/// Compares all models on the evaluation clips of the sessions of their activity. Returns
///   results: rows {activity, object, split, model, l1_at_20, l1_at_50, hausdorff, coverage, ...}
///   differences: full - without_touch and full - without_embedding, with bootstrap intervals
///   curves: L1 and coverage by step
///   examples: some roll-outs with their tactile frames, for the report
///   models: their cards
///   label_errors: errors of the labels relative to the truth, if any
///   against: "truth" or "labels", the reference of `results`
///   scaling: mean and deviation by activity
/// Throws data_error if a model has no session of its activity or the evaluation clips are too few
/// or too short.
nlohmann::json evaluate_models(const std::vector<Session>& sessions,
                               std::vector<LoadedModel>& models, const EvaluationOptions& options);

}  // namespace touchtrace::study
