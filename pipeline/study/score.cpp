#include "pipeline/study/score.h"

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/finite.h"

namespace touchtrace::study {
namespace {

constexpr Metric metrics[] = {
    {"l1_at_20", [](const CaseScore& s) { return s.l1_at_20; }},
    {"l1_at_50", [](const CaseScore& s) { return s.l1_at_50; }},
    {"hausdorff", [](const CaseScore& s) { return s.hausdorff; }},
    {"object_error_m_at_20", [](const CaseScore& s) { return s.object.m_at_20; }},
    {"object_error_m_at_50", [](const CaseScore& s) { return s.object.m_at_50; }},
    {"object_error_m_per_s_at_20", [](const CaseScore& s) { return s.object.m_per_s_at_20; }},
    {"object_error_m_per_s_at_50", [](const CaseScore& s) { return s.object.m_per_s_at_50; }},
    {"object_hausdorff_m", [](const CaseScore& s) { return s.object.hausdorff_m; }},
    {"hand_error_m_at_20", [](const CaseScore& s) { return s.hand.m_at_20; }},
    {"hand_error_m_at_50", [](const CaseScore& s) { return s.hand.m_at_50; }},
    {"hand_error_m_per_s_at_20", [](const CaseScore& s) { return s.hand.m_per_s_at_20; }},
    {"hand_error_m_per_s_at_50", [](const CaseScore& s) { return s.hand.m_per_s_at_50; }},
    {"hand_hausdorff_m", [](const CaseScore& s) { return s.hand.hausdorff_m; }},
};

/// Predicted and target path of a roll-out, with the weights of their steps.
struct Pair {
  Path predicted, target;
  std::span<const float> weight;

  double distance(Dimensions dimensions, int steps) const {
    return mean_until(distance_by_step(predicted, target, dimensions), weight, steps);
  }
  double hausdorff(Dimensions dimensions = {}) const {
    return study::hausdorff(weighted_steps(predicted, weight), weighted_steps(target, weight),
                            dimensions);
  }
};

BodyScore score_body(const Pair& metres, Dimensions position, Dimensions velocity) {
  return {metres.distance(position, short_horizon_steps), metres.distance(position, horizon_steps),
          metres.distance(velocity, short_horizon_steps), metres.distance(velocity, horizon_steps),
          metres.hausdorff(position)};
}

CaseScore score_case(const Pair& scaled, const Pair& metres) {
  CaseScore score{};
  score.l1_by_step = l1_by_step(scaled.predicted, scaled.target);
  score.l1_at_20 = mean_until(score.l1_by_step, scaled.weight, short_horizon_steps);
  score.l1_at_50 = mean_until(score.l1_by_step, scaled.weight, horizon_steps);
  score.hausdorff = scaled.hausdorff();
  score.object = score_body(metres, object_position, object_velocity);
  score.hand = score_body(metres, hand_position, hand_velocity);
  for (std::size_t step = 0; step < score.l1_by_step.size(); ++step)
    if (scaled.weight[step] <= 0.0f)
      score.l1_by_step[step] = std::numeric_limits<double>::quiet_NaN();
  return score;
}

Normalization unscaled() {
  Normalization identity;
  identity.sigma.fill(1.0f);
  return identity;
}

}  // namespace

std::span<const Metric> all_metrics() { return metrics; }

std::vector<CaseScore> score(const std::vector<float>& paths, const RolloutCases& cases,
                             const Normalization& scaling) {
  if (!all_finite(paths))
    throw failure("paths to be scored are not finite", "report this as a bug");
  const auto paths_m = rescaled(paths, scaling, unscaled());
  const auto target_m = rescaled(cases.batch.target, scaling, unscaled());
  const std::size_t size = cases.path_size(), steps = static_cast<std::size_t>(cases.batch.steps);
  std::vector<CaseScore> scores;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cases.count()); ++i) {
    const auto path = [&](const std::vector<float>& all) {
      return Path(all).subspan(i * size, size);
    };
    const auto weight = std::span(cases.batch.weight).subspan(i * steps, steps);
    scores.push_back(score_case({path(paths), path(cases.batch.target), weight},
                                {path(paths_m), path(target_m), weight}));
  }
  return scores;
}

double nan_mean(const std::vector<double>& values) {
  double sum = 0.0;
  int count = 0;
  for (double value : values)
    if (!std::isnan(value)) sum += value, ++count;
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

nlohmann::json summary(const std::vector<CaseScore>& scores, const std::vector<int>& which) {
  nlohmann::json means;
  for (const Metric& metric : metrics) {
    std::vector<double> values;
    for (int i : which) values.push_back(metric.value(scores[i]));
    means[metric.name] = nan_mean(values);
  }
  return means;
}

std::vector<double> mean_curve(const std::vector<CaseScore>& scores,
                               const std::vector<int>& which) {
  std::vector<double> curve;
  for (std::size_t step = 0; !scores.empty() && step < scores.front().l1_by_step.size(); ++step) {
    std::vector<double> values;
    for (int i : which) values.push_back(scores[i].l1_by_step[step]);
    curve.push_back(nan_mean(values));
  }
  return curve;
}

}  // namespace touchtrace::study
