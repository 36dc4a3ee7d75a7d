#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/train/predictor.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/rollouts.h"
#include "pipeline/study/score.h"
#include "pipeline/study/truth.h"

namespace touchtrace::study {

/// Labelled recording to evaluate on.
struct Session {
  std::string name;
  Dataset data;  ///< truth, if any, shifted by `offset`
  TruthOffset offset;
  nlohmann::json label_error;  ///< of compare_labels_with_truth; null without truth
};

/// Trained model, loaded on a device.
struct LoadedModel {
  std::string path;
  ModelCard card;
  std::unique_ptr<Predictor> predictor;
};

/// Predictions and scores of a model or of the baseline Random.
struct Candidate {
  std::string name;
  const LoadedModel* model;  ///< null for Random
  Rollout rollout;           ///< in the comparison's scaling; no spread for Random
  std::vector<CaseScore> scores, label_scores;  ///< relative to the reference, to the labels
};

/// Random and all models of one activity on the same roll-outs of the evaluation clips.
struct Comparison {
  std::vector<const Session*> sessions;
  Reference reference = Reference::labels;
  Normalization scaling;            ///< of the first model: mean and sigma of its training labels
  int history = 1;                  ///< frames of touch before a start, largest of all models
  RolloutCases cases, label_cases;  ///< same starts; `sequence` counts over all sessions
  std::vector<int> session;         ///< [cases]
  std::vector<std::string> object;  ///< [cases]
  std::vector<Candidate> candidates;

  const ModelCard& card() const { return candidates.back().model->card; }
  /// Returns null for an unknown name.
  const Candidate* find(const std::string& name) const;
  /// Case indices by object.
  std::vector<std::pair<std::string, std::vector<int>>> objects() const;
};

/// Predicts and scores all roll-outs that start every `stride` frames. `seed`: of Random. Throws
/// data_error if the evaluation clips hold fewer than two roll-outs.
Comparison compare_models(const std::vector<const Session*>& sessions,
                          const std::vector<LoadedModel*>& models, Reference reference, int stride,
                          std::uint64_t seed);

/// [steps] Coverage of a candidate's band over the cases `which`, with its band scale or as
/// predicted; empty for Random.
std::vector<double> coverage_of(const Candidate& candidate, const RolloutCases& cases,
                                const std::vector<int>& which, bool scaled);

}  // namespace touchtrace::study
