#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/study/model_groups.h"
#include "pipeline/study/rollouts.h"
#include "pipeline/study/score.h"

namespace touchtrace::study {

/// Labelled recording to evaluate on. Clips of Split::evaluation are rolled out.
struct Session {
  std::string name;
  Dataset data;                ///< at the glove's resolution; truth, if any, shifted (truth.h)
  nlohmann::json label_error;  ///< of compare_labels_with_truth; null without truth
};

/// Roll-outs of all sessions with the targets of one reference.
struct Target {
  std::string name;    ///< "truth", "labels" or "unshifted_truth"
  RolloutCases cases;  ///< `sequence` counts over all sessions
};

/// Paths of one model or baseline.
struct Run {
  const LoadedModel* model;  ///< null for a baseline
  Rollout rollout;           ///< in the comparison's scaling; no spread for a baseline
  std::vector<std::vector<CaseScore>> scores;  ///< [targets][cases]
};

/// Kind of the control of "full": the same weights with the touch of other roll-outs. A gain over
/// "without_touch" that it shares does not come from touch. Its own loss is no measure of a gain:
/// wrong touch misleads a model that uses touch.
inline constexpr const char* other_touch_kind = "other_touch";

/// Models that differ in their seed only, or a baseline.
struct Candidate {
  std::string name, kind;
  std::vector<Run> runs;
  nlohmann::json options = nlohmann::json::object();  ///< ModelGroup::options

  bool is_baseline() const { return !runs.front().model; }
};

/// Models of one activity and baselines on the same roll-outs of the evaluation clips.
struct Comparison {
  std::vector<const Session*> sessions;
  Normalization scaling;            ///< of the first model: mean and sigma of its training labels
  int history = 1;                  ///< frames of touch before a start, largest of all models
  std::vector<Target> targets;      ///< same starts; the first is the reference of the results
  std::vector<int> session;         ///< [cases]
  std::vector<std::string> object;  ///< [cases]
  std::vector<Candidate> candidates;

  const RolloutCases& cases() const { return targets.front().cases; }
  /// First candidate of a kind, or null.
  const Candidate* find(const std::string& kind) const;
  /// Case indices by object.
  std::vector<std::pair<std::string, std::vector<int>>> objects() const;
};

/// Predicts and scores all roll-outs that start every `stride` frames, for models of one activity.
/// "full" is followed by its control. `reference`: Reference::truth adds the targets "labels" and
/// "unshifted_truth". `seed`: of Random. Throws data_error if the evaluation clips hold fewer than
/// two roll-outs, or a glove has fewer taxels than a model.
Comparison compare_models(const std::vector<const Session*>& sessions,
                          const std::vector<LoadedModel*>& models, Reference reference, int stride,
                          std::uint64_t seed);

/// [steps] Coverage of a model's band over the cases `which`, with its band scale or as predicted;
/// empty for a baseline.
std::vector<double> coverage_of(const Run& run, const RolloutCases& cases,
                                const std::vector<int>& which, bool scaled);

}  // namespace touchtrace::study
