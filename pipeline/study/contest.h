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

/// A recording with its labels, ready to be evaluated on.
struct Session {
  std::string name;
  Dataset data;  ///< truth, where there is one, shifted by `offset`
  TruthOffset offset;
  nlohmann::json label_error;  ///< of compare_labels_with_truth; null without truth
};

/// A trained model on its device.
struct LoadedModel {
  std::string path;
  ModelCard card;
  std::unique_ptr<Predictor> predictor;
};

/// What a model, or the baseline Random, says of every case, and how good that is.
struct Contender {
  std::string name;
  const LoadedModel* model;                     ///< null for Random
  Rollout rollout;                              ///< in the contest's scaling; Random has no spread
  std::vector<CaseScore> scores, label_scores;  ///< against the reference, and against the labels
};

/// Random and the models of one activity on the same roll-outs of the evaluation clips.
struct Contest {
  std::vector<const Session*> sessions;
  Reference reference = Reference::labels;
  Normalization scaling;  ///< of the first model: its training labels' deviation
  int history = 1;        ///< frames of touch before a start, of the model that needs most
  RolloutCases cases, label_cases;  ///< the same starts; `sequence` numbers clips over all sessions
  std::vector<int> session;         ///< [cases]
  std::vector<std::string> object;  ///< [cases]
  std::vector<Contender> contenders;

  const ModelCard& card() const { return contenders.back().model->card; }
  /// Null if there is none of that name.
  const Contender* find(const std::string& name) const;
  /// Indices of the cases of each object.
  std::vector<std::pair<std::string, std::vector<int>>> objects() const;
};

/// Throws data_error if the evaluation clips give less than two roll-outs.
Contest hold_contest(const std::vector<const Session*>& sessions,
                     const std::vector<LoadedModel*>& models, Reference reference, int stride,
                     std::uint64_t seed);

/// Coverage of a contender's band per step over the cases `which`, scaled or as predicted; empty
/// for Random.
std::vector<double> coverage_of(const Contender& contender, const RolloutCases& cases,
                                const std::vector<int>& which, bool scaled);

}  // namespace touchtrace::study
