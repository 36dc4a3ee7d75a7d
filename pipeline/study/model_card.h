#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/provenance.h"
#include "engine/model/model_spec.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/study/band.h"

namespace touchtrace::study {

/// One look at the validation clips while training.
struct TrainingLogEntry {
  int update = 0;
  double seconds = 0.0;        ///< spent on updates so far, by the wall clock
  double training_loss = 0.0;  ///< mean since the last entry
  double validation_loss = 0.0, validation_l1_at_20 = 0.0, validation_l1_at_50 = 0.0;
};

/// What a model file says of itself beside its weights.
struct ModelCard {
  ModelSpec spec;
  Normalization scaling;  ///< of the states that it takes and gives
  std::string activity;
  std::vector<std::string> objects;  ///< seen in training
  double rate_hz = 15.0;             ///< of the tactile frames
  int update = 0;                    ///< after which the weights did best on validation clips
  BandScale band_scale;              ///< fitted on validation clips; empty without any
  std::vector<TrainingLogEntry> log;
  Provenance provenance;

  /// "full", "without_touch", or "without_embedding": with touch, but of several objects that
  /// nothing tells apart.
  std::string name() const;
};

void to_json(nlohmann::json& json, const TrainingLogEntry& entry);
void from_json(const nlohmann::json& json, TrainingLogEntry& entry);
void to_json(nlohmann::json& json, const ModelCard& card);
void from_json(const nlohmann::json& json, ModelCard& card);

/// The card of a model file. Throws data_error if the file was not made by `touchtrace train`.
ModelCard read_card(const nlohmann::json& metadata, const std::string& path);

}  // namespace touchtrace::study
