#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/train/predictor.h"
#include "pipeline/study/model_card.h"

namespace touchtrace::study {

/// Trained model, loaded on a device.
struct LoadedModel {
  std::string path;
  ModelCard card;
  std::unique_ptr<Predictor> predictor;
};

/// Models that differ in their seed only.
struct ModelGroup {
  std::string name;  ///< kind and `options`
  std::string kind;  ///< ModelCard::name()
  std::vector<LoadedModel*> models;
  /// Training options that other groups of the kind have not, by key; "data": hashes of the
  /// training data.
  nlohmann::json options = nlohmann::json::object();
};

/// Training options in which models of two kinds differ, other than those that make the kinds, as
/// "updates 600 and 100, window 8 and 4"; empty: none.
std::string training_difference(const LoadedModel& a, const LoadedModel& b);

/// Groups models by kind, training options and training data, in the order of their first model.
/// Throws usage_error if two of a group have the same seed: they are one training.
std::vector<ModelGroup> group_models(const std::vector<LoadedModel*>& models);

}  // namespace touchtrace::study
