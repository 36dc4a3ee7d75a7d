#include "pipeline/study/model_groups.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/json_text.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

/// Options that do not change what a model is.
constexpr const char* irrelevant_options[] = {
    "seed", "output", "resume", "checkpoint_seconds", "skip_not_finite", "recording", "labels"};

/// Options that make a model's kind.
constexpr const char* kind_options[] = {"without_touch", "object_encoder", "data"};

/// Training options and hashes of the training data.
json recipe(const LoadedModel& model) {
  const Provenance& provenance = model.card.provenance;
  json options = provenance.options.is_object() ? provenance.options : json::object();
  for (const char* option : irrelevant_options) options.erase(option);
  std::vector<std::string> data;
  for (const auto& input : provenance.inputs) data.push_back(input.sha256.substr(0, 8));
  std::ranges::sort(data);
  options["data"] = fmt::format("{}", fmt::join(data, "+"));
  return options;
}

/// Entries of `own` that another recipe has not.
json distinction(const json& own, const std::vector<json>& others) {
  json different = json::object();
  for (const auto& [key, value] : own.items())
    if (std::ranges::any_of(others, [&](const json& other) {
          return !other.contains(key) || other.at(key) != value;
        }))
      different[key] = value;
  return different;
}

/// " key=value" for each option.
std::string text_of(const json& options) {
  std::string text;
  for (const auto& [key, value] : options.items())
    text += fmt::format(" {}={}", key, json_text(value));
  return text;
}

void require_new_seed(const std::vector<LoadedModel*>& models, const LoadedModel& model) {
  for (const LoadedModel* other : models)
    if (other->card.provenance.seed == model.card.provenance.seed)
      throw usage_error(fmt::format("{} and {} are trainings with the same options and seed {}",
                                    other->path, model.path, model.card.provenance.seed),
                        "give each training once: a copy is not another seed");
}

}  // namespace

std::string training_difference(const LoadedModel& a, const LoadedModel& b) {
  json of_a = recipe(a), of_b = recipe(b);
  for (const char* option : kind_options) of_a.erase(option), of_b.erase(option);
  const auto text = [](const json& options, const std::string& key) {
    return options.contains(key) ? json_text(options.at(key)) : "not given";
  };
  json different = distinction(of_a, {of_b});
  different.update(distinction(of_b, {of_a}));
  std::vector<std::string> texts;
  for (const auto& entry : different.items())
    texts.push_back(
        fmt::format("{} {} and {}", entry.key(), text(of_a, entry.key()), text(of_b, entry.key())));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::vector<ModelGroup> group_models(const std::vector<LoadedModel*>& models) {
  std::vector<ModelGroup> groups;
  std::vector<json> recipes;
  for (LoadedModel* model : models) {
    const std::string kind = model->card.name();
    const json own = recipe(*model);
    std::size_t i = 0;
    while (i < groups.size() && !(groups[i].kind == kind && recipes[i] == own)) ++i;
    if (i == groups.size()) groups.push_back({"", kind, {}, {}}), recipes.push_back(own);
    require_new_seed(groups[i].models, *model);
    groups[i].models.push_back(model);
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::vector<json> others;
    for (std::size_t j = 0; j < groups.size(); ++j)
      if (j != i && groups[j].kind == groups[i].kind) others.push_back(recipes[j]);
    groups[i].options = distinction(recipes[i], others);
    groups[i].name = groups[i].kind + text_of(groups[i].options);
  }
  return groups;
}

}  // namespace touchtrace::study
