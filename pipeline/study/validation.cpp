#include "pipeline/study/validation.h"

#include "engine/base/progress.h"
#include "engine/train/predictor.h"
#include "pipeline/study/score.h"

namespace touchtrace::study {
namespace {

constexpr int stride_frames = 10;

}  // namespace

Validation::Validation(Runtime& runtime, const Dataset& data, const ModelCard& card)
    : runtime_(runtime), data_(data), band_quantile_(card.spec.band_quantile) {
  const auto cases_of = [&](Split split) {
    return make_cases(data, {split, horizon_steps, stride_frames, required_history(card.spec)},
                      card.scaling, Reference::labels);
  };
  cases_ = cases_of(Split::validation);
  calibration_ = cases_of(Split::calibration);
}

Rollout Validation::predict(const TensorFile& model, const RolloutCases& cases) const {
  return Predictor(runtime_, model).predict(cases.batch, data_.tactile);
}

void Validation::evaluate(const TensorFile& model, TrainingLogEntry& entry) const {
  const Rollout rollout = predict(model, cases_);
  std::vector<double> at_20, at_50;
  const auto size = cases_.path_size(), steps = static_cast<std::size_t>(cases_.batch.steps);
  for (std::size_t i = 0; i < static_cast<std::size_t>(cases_.count()); ++i) {
    const auto errors = l1_by_step(Path(rollout.state).subspan(i * size, size),
                                   Path(cases_.batch.target).subspan(i * size, size));
    const auto weight = std::span(cases_.batch.weight).subspan(i * steps, steps);
    at_20.push_back(mean_until(errors, weight, short_horizon_steps));
    at_50.push_back(mean_until(errors, weight, horizon_steps));
  }
  entry.validation_loss = mean_loss(rollout, cases_.batch, band_quantile_);
  entry.validation_l1_at_20 = nan_mean(at_20);
  entry.validation_l1_at_50 = nan_mean(at_50);
}

BandScale Validation::band_scale(const TensorFile& model) const {
  if (calibration_.count() == 0) return {};
  const Rollout rollout = predict(model, calibration_);
  if (is_finite(rollout))
    return fit_band_scale(rollout, calibration_.batch, nominal_coverage(band_quantile_));
  Progress::warn("predictions for the calibration clips are not finite: bands are not scaled");
  return {};
}

}  // namespace touchtrace::study
