#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "pipeline/study/contest.h"

namespace touchtrace::study {

/// Options of `touchtrace evaluate`.
struct EvaluationOptions {
  std::vector<std::string> recordings, labels;  ///< pairs, in the same order
  std::vector<std::string> models;
  std::string output, accuracy = "fast";
  std::string against = "auto";  ///< "truth", "labels", or truth where there is one
  int stride = 5;                ///< frames from one start to the next
  std::uint64_t seed = 1;
};

void describe(OptionSet& set, EvaluationOptions& options);

/// Throws data_error for a file that `touchtrace train` did not make.
LoadedModel load_model(Runtime& runtime, const std::string& path);

/// Rolls every model out on the evaluation clips of the sessions of its activity. The document has
///   results      rows {activity, object, split, model, l1_at_20, l1_at_50, hausdorff, coverage,
///   ...} differences  full - without_touch with its bootstrap interval curves       L1 and
///   coverage of each step examples     some roll-outs with their tactile frames, for the report
///   models       their cards
///   label_errors labels against truth, where there is one
///   against      "truth" or "labels", what the results are held against; scaling, device
/// Throws data_error if a model fits no session or the evaluation clips are too few or too short.
nlohmann::json evaluate_models(const std::vector<Session>& sessions,
                               std::vector<LoadedModel>& models, const EvaluationOptions& options);

}  // namespace touchtrace::study
