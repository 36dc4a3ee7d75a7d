#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/provenance.h"
#include "engine/model/model_spec.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/study/band.h"

namespace touchtrace::study {

/// Validation during training.
struct TrainingLogEntry {
  int update = 0;
  double seconds = 0.0;        ///< wall time of updates so far
  double training_loss = 0.0;  ///< mean since the entry before
  double validation_loss = 0.0, validation_l1_at_20 = 0.0, validation_l1_at_50 = 0.0;
};

/// First entry with the smallest validation L1@50; the last one if it is undefined in all.
const TrainingLogEntry& best_entry(const std::vector<TrainingLogEntry>& log);

/// Names and units of the 12 state dimensions; the frame is that of the colour camera.
extern const std::array<const char*, state_size> state_dimensions;

/// Metadata of a model file.
struct ModelCard {
  ModelSpec spec;
  Normalization scaling;  ///< of input and output states
  std::string activity;
  std::vector<std::string> objects;  ///< seen in training
  double rate_hz = 15.0;             ///< of the tactile frames
  int update = 0;        ///< whose weights the file holds: best L1@50 on validation clips
  BandScale band_scale;  ///< fitted on calibration clips; empty without them
  std::vector<std::string> seen_clips;  ///< sorted fingerprints of the clips of all these splits
  std::vector<std::string> warnings;    ///< of the recordings and labels of the training
  std::vector<TrainingLogEntry> log;
  Provenance provenance;
  /// [embedding] Mean of the training objects, for live prediction before the object is known;
  /// empty without an object encoder, or in older files.
  std::vector<float> mean_embedding;

  /// "full", "without_touch", or "without_embedding": touch and several objects, but no object
  /// encoder.
  std::string name() const;
  /// Validation of the weights in the file; null without validation clips.
  const TrainingLogEntry* saved_entry() const;
};

void to_json(nlohmann::json& json, const TrainingLogEntry& entry);
void from_json(const nlohmann::json& json, TrainingLogEntry& entry);
void to_json(nlohmann::json& json, const ModelCard& card);
void from_json(const nlohmann::json& json, ModelCard& card);

/// Throws data_error unless a glove has the rate of the model's training within 2 %. `model`,
/// `source` (recording or port): names for the message.
void require_rate(const ModelCard& card, const std::string& model, double rate_hz,
                  const std::string& source);

/// Reads the card of a model file. Throws data_error if `touchtrace train` did not write the file.
ModelCard read_card(const nlohmann::json& metadata, const std::string& path);

}  // namespace touchtrace::study
