#pragma once

#include <memory>
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
  std::string name;  ///< kind, with the options that tell groups of one kind apart
  std::string kind;  ///< ModelCard::name()
  std::vector<LoadedModel*> models;
};

/// Groups models by kind, training options and training data, in the order of their first model.
std::vector<ModelGroup> group_models(const std::vector<LoadedModel*>& models);

}  // namespace touchtrace::study
