#include "pipeline/study/model_card.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace touchtrace::study {
namespace {

constexpr double rate_tolerance = 0.02;

bool is_valid(const ModelCard& card) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(card.scaling.sigma, positive) &&
         std::ranges::all_of(card.scaling.mean, finite) &&
         std::ranges::all_of(card.band_scale, positive) && positive(card.rate_hz) &&
         std::ranges::all_of(card.mean_embedding, finite) &&
         (card.mean_embedding.empty() || std::ssize(card.mean_embedding) == card.spec.embedding);
}

/// JSON has no NaN: null stands for it.
double value_or_nan(const nlohmann::json& value) {
  return value.is_null() ? std::nan("") : value.get<double>();
}

}  // namespace

const std::array<const char*, state_size> state_dimensions{
    "object x [m]",    "object y [m]",    "object z [m]",  "object vx [m/s]",
    "object vy [m/s]", "object vz [m/s]", "hand x [m]",    "hand y [m]",
    "hand z [m]",      "hand vx [m/s]",   "hand vy [m/s]", "hand vz [m/s]"};

const TrainingLogEntry& best_entry(const std::vector<TrainingLogEntry>& log) {
  const TrainingLogEntry* best = nullptr;
  for (const auto& entry : log)
    if (!std::isnan(entry.validation_l1_at_50) &&
        (!best || entry.validation_l1_at_50 < best->validation_l1_at_50))
      best = &entry;
  return best ? *best : log.back();
}

std::string ModelCard::name() const {
  if (!spec.touch) return "without_touch";
  return objects.size() > 1 && spec.object == ObjectEncoder::none ? "without_embedding" : "full";
}

const TrainingLogEntry* ModelCard::saved_entry() const {
  const auto entry = std::ranges::find(log, update, &TrainingLogEntry::update);
  return entry == log.end() ? nullptr : &*entry;
}

void to_json(nlohmann::json& json, const TrainingLogEntry& entry) {
  json = {{"update", entry.update},
          {"seconds", entry.seconds},
          {"training_loss", entry.training_loss},
          {"validation_loss", entry.validation_loss},
          {"validation_l1_at_20", entry.validation_l1_at_20},
          {"validation_l1_at_50", entry.validation_l1_at_50}};
}

void from_json(const nlohmann::json& json, TrainingLogEntry& entry) {
  entry.update = json.at("update");
  entry.seconds = json.at("seconds");
  entry.training_loss = value_or_nan(json.at("training_loss"));
  entry.validation_loss = value_or_nan(json.at("validation_loss"));
  entry.validation_l1_at_20 = value_or_nan(json.at("validation_l1_at_20"));
  entry.validation_l1_at_50 = value_or_nan(json.at("validation_l1_at_50"));
}

void to_json(nlohmann::json& json, const ModelCard& card) {
  json = {{"spec", card.spec},
          {"scaling", {{"mean", card.scaling.mean}, {"deviation", card.scaling.sigma}}},
          {"activity", card.activity},
          {"objects", card.objects},
          {"rate_hz", card.rate_hz},
          {"update", card.update},
          {"band_scale", card.band_scale},
          {"seen_clips", card.seen_clips},
          {"state", state_dimensions},
          {"log", card.log},
          {"provenance", card.provenance}};
  if (!card.warnings.empty()) json["warnings"] = card.warnings;
  if (!card.mean_embedding.empty()) json["mean_embedding"] = card.mean_embedding;
}

void from_json(const nlohmann::json& json, ModelCard& card) {
  card.spec = json.at("spec");
  card.scaling.mean = json.at("scaling").at("mean");
  card.scaling.sigma = json.at("scaling").at("deviation");
  card.activity = json.at("activity");
  card.objects = json.at("objects").get<std::vector<std::string>>();
  card.rate_hz = json.at("rate_hz");
  card.update = json.at("update");
  card.band_scale = json.at("band_scale").get<BandScale>();
  card.seen_clips = json.at("seen_clips").get<std::vector<std::string>>();
  card.log = json.at("log").get<std::vector<TrainingLogEntry>>();
  card.provenance = json.at("provenance");
  card.warnings = json.value("warnings", std::vector<std::string>());
  card.mean_embedding = json.value("mean_embedding", std::vector<float>());
}

ModelCard read_card(const nlohmann::json& metadata, const std::string& path) {
  if (metadata.is_object() && !metadata.contains("seen_clips"))
    throw data_error(fmt::format("{} does not name the clips that it was trained on", path),
                     "train it again with this version of touchtrace");
  if (metadata.is_object() && metadata.value("state", nlohmann::json()) != state_dimensions)
    throw data_error(
        fmt::format("{} predicts another state than object and hand in m and m/s", path),
        "train it again with this version of touchtrace");
  try {
    ModelCard card = metadata;
    if (is_valid(card)) return card;
  } catch (const nlohmann::json::exception&) {
  }
  throw data_error(fmt::format("{} has no valid description of its model", path),
                   "use a file that `touchtrace train` wrote");
}

void require_rate(const ModelCard& card, const std::string& model, double rate_hz,
                  const std::string& source) {
  if (!(std::abs(rate_hz / card.rate_hz - 1.0) <= rate_tolerance))
    throw data_error(fmt::format("{} was trained at {:.4g} Hz, the glove of {} has {:.4g} Hz",
                                 model, card.rate_hz, source, rate_hz),
                     "frames are not resampled: use a glove of the same rate; that of a live glove "
                     "is --rate-hz");
}

}  // namespace touchtrace::study
