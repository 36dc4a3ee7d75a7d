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

/// Groups models by kind, training options and training data, in the order of their first model.
std::vector<ModelGroup> group_models(const std::vector<LoadedModel*>& models);

}  // namespace touchtrace::study
