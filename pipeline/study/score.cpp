#include "pipeline/study/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/random.h"

namespace touchtrace::study {
namespace {

constexpr int object_position = 0, hand_position = 6;
constexpr int bootstrap_samples = 2000;

void require_finite(const std::vector<float>& paths) {
  if (!std::ranges::all_of(paths, [](float value) { return std::isfinite(value); }))
    throw failure("model predicts non-finite values", "train again with a lower --learning-rate");
}

CaseScore score_case(Path predicted, Path target, std::span<const float> weight, Path predicted_m,
                     Path target_m) {
  const auto object = distance_by_step(predicted_m, target_m, object_position);
  const auto hand = distance_by_step(predicted_m, target_m, hand_position);
  CaseScore score{};
  score.l1_by_step = l1_by_step(predicted, target);
  score.l1_at_20 = mean_until(score.l1_by_step, weight, short_horizon_steps);
  score.l1_at_50 = mean_until(score.l1_by_step, weight, horizon_steps);
  score.hausdorff = hausdorff(predicted, target);
  score.object_m_at_20 = mean_until(object, weight, short_horizon_steps);
  score.object_m_at_50 = mean_until(object, weight, horizon_steps);
  score.hand_m_at_20 = mean_until(hand, weight, short_horizon_steps);
  score.hand_m_at_50 = mean_until(hand, weight, horizon_steps);
  return score;
}

/// Sums of (a - b) and numbers of roll-outs by clip.
std::vector<std::pair<double, int>> sums_by_clip(const std::vector<double>& a,
                                                 const std::vector<double>& b,
                                                 const std::vector<int>& clip) {
  std::map<int, std::pair<double, int>> sums;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    auto& [sum, count] = sums[clip[i]];
    sum += a[i] - b[i];
    ++count;
  }
  std::vector<std::pair<double, int>> clips;
  for (const auto& [number, entry] : sums) clips.push_back(entry);
  return clips;
}

double resampled_mean(const std::vector<std::pair<double, int>>& clips, RandomStream& random) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t draw = 0; draw < clips.size(); ++draw) {
    const auto& [clip_sum, clip_count] = clips[random.below(clips.size())];
    sum += clip_sum;
    count += clip_count;
  }
  return sum / count;
}

}  // namespace

std::vector<CaseScore> score(const std::vector<float>& paths, const RolloutCases& cases,
                             const Normalization& scaling) {
  require_finite(paths);
  const Normalization metres{{}, [] {
                               State ones;
                               ones.fill(1.0f);
                               return ones;
                             }()};
  const auto paths_m = rescaled(paths, scaling, metres);
  const auto target_m = rescaled(cases.batch.target, scaling, metres);
  const std::size_t size = cases.path_size(), steps = static_cast<std::size_t>(cases.batch.steps);
  std::vector<CaseScore> scores;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cases.count()); ++i) {
    const auto path = [&](const std::vector<float>& all) {
      return Path(all).subspan(i * size, size);
    };
    scores.push_back(score_case(path(paths), path(cases.batch.target),
                                std::span(cases.batch.weight).subspan(i * steps, steps),
                                path(paths_m), path(target_m)));
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
  const auto mean = [&](double CaseScore::*member) {
    std::vector<double> values;
    for (int i : which) values.push_back(scores[i].*member);
    return nan_mean(values);
  };
  return {{"l1_at_20", mean(&CaseScore::l1_at_20)},
          {"l1_at_50", mean(&CaseScore::l1_at_50)},
          {"hausdorff", mean(&CaseScore::hausdorff)},
          {"object_error_m_at_20", mean(&CaseScore::object_m_at_20)},
          {"object_error_m_at_50", mean(&CaseScore::object_m_at_50)},
          {"hand_error_m_at_20", mean(&CaseScore::hand_m_at_20)},
          {"hand_error_m_at_50", mean(&CaseScore::hand_m_at_50)}};
}

std::vector<double> mean_curve(const std::vector<CaseScore>& scores,
                               const std::vector<int>& which) {
  std::vector<double> curve(scores.empty() ? 0 : scores.front().l1_by_step.size(), 0.0);
  for (int i : which)
    for (std::size_t step = 0; step < curve.size(); ++step)
      curve[step] += scores[i].l1_by_step[step] / static_cast<double>(which.size());
  return curve;
}

Difference bootstrap_difference(const std::vector<double>& a, const std::vector<double>& b,
                                const std::vector<int>& clip, std::uint64_t seed) {
  const auto clips = sums_by_clip(a, b, clip);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (clips.empty()) return {nan, nan, nan};
  double sum = 0.0;
  int count = 0;
  for (const auto& [clip_sum, clip_count] : clips) sum += clip_sum, count += clip_count;
  RandomStream random(seed, "bootstrap");
  std::vector<double> means(bootstrap_samples);
  for (double& mean : means) mean = resampled_mean(clips, random);
  std::ranges::sort(means);
  return {sum / count, means[bootstrap_samples / 40],
          means[bootstrap_samples - 1 - bootstrap_samples / 40]};
}

}  // namespace touchtrace::study
