#include "pipeline/study/label_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/statistics.h"
#include "pipeline/study/truth_samples.h"

namespace touchtrace::study {
namespace {

constexpr double impact_m_per_s2 = 40.0, wrong_m = 0.060, sigmas_of_80_percent = 1.2815515655446004;
constexpr double max_delay_s = 0.35;  // as labelling looks for latencies
constexpr double delay_step_s = 0.008, min_delay_step_s = 0.00025;

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// One label compared with the truth.
struct Sample {
  Vector6 error;  ///< position, velocity
  Eigen::Vector3d causal_velocity_error;
  Matrix6 covariance;
  std::uint8_t quality;  ///< LabelQuality
  bool in_image;
  bool has_true_velocity;  ///< no impact between the surrounding samples of the truth

  bool is_lost() const { return (quality & (quality_lost | quality_gap)) != 0; }
};

/// Labels compared with the truth `delay_s` before their times.
std::vector<Sample> samples_of(const Labels& labels, const LabelledBody& body, const Truth& truth,
                               const Truth::Body& true_body, double delay_s) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    const auto interval = find_interval(truth, labels.clip[i], labels.time_s[i] - delay_s);
    if (!interval || !std::isfinite(body.position_m[3 * i])) continue;
    Sample sample;
    const Eigen::Vector3d position = interpolate(true_body.position_m, *interval),
                          velocity = interpolate(true_body.velocity_m_per_s, *interval);
    sample.error << row(body.position_m, i) - position, row(body.velocity_m_per_s, i) - velocity;
    sample.causal_velocity_error = row(body.causal_velocity_m_per_s, i) - velocity;
    sample.covariance = Eigen::Map<const Matrix6>(&body.covariance[36 * i]);
    sample.quality = body.quality[i];
    sample.in_image = in_image(truth, position);
    sample.has_true_velocity = acceleration(truth, true_body, *interval) < impact_m_per_s2;
    samples.push_back(std::move(sample));
  }
  return samples;
}

Eigen::Vector3d median_offset(const std::vector<Sample>& samples) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& sample : samples) values.push_back(sample.error[axis]);
    result[axis] = median(std::move(values));
  }
  return result;
}

double covered(const Sample& sample, int first) {
  double count = 0.0;
  for (int i = first; i < first + 3; ++i)
    count += std::abs(sample.error[i]) < sigmas_of_80_percent * std::sqrt(sample.covariance(i, i));
  return count / 3.0;
}

/// Returns the samples neither lost nor wrong and adds up the shares of `error`.
std::vector<Sample> select_right(const std::vector<Sample>& samples, BodyError& error) {
  const Eigen::Vector3d offset = median_offset(samples);
  std::vector<Sample> right;
  const double share = 1.0 / static_cast<double>(samples.size());
  for (const auto& sample : samples) {
    const bool wrong = !((sample.error.head<3>() - offset).norm() < wrong_m);
    error.outside_share += share * !sample.in_image;
    error.lost_share += share * (sample.is_lost() && sample.in_image);
    error.follows_share += share * ((sample.quality & quality_follows_hand) != 0);
    error.wrong_share += share * (wrong && !sample.is_lost());
    error.wrong_unsaid_share += share * (wrong && sample.quality == quality_good);
    if (!wrong && !sample.is_lost()) right.push_back(sample);
  }
  return right;
}

/// Mean squared distance of labels and truth, truncated at wrong_m.
double distance_cost(const std::vector<Sample>& samples) {
  const Eigen::Vector3d offset = median_offset(samples);
  double cost = 0.0;
  for (const auto& sample : samples)
    cost += std::min((sample.error.head<3>() - offset).squaredNorm(), wrong_m * wrong_m);
  return cost / static_cast<double>(samples.size());
}

/// Delay that minimises distance_cost: grid search, then halved steps. Delays that leave fewer than
/// half of the samples are not looked at.
double estimate_delay(const std::function<std::vector<Sample>(double)>& samples_at) {
  const auto undelayed = samples_at(0.0);
  double best_s = 0.0, lowest = distance_cost(undelayed);
  const auto evaluate = [&](double delay_s) {
    const auto samples = samples_at(delay_s);
    if (2 * samples.size() < undelayed.size()) return;
    const double cost = distance_cost(samples);
    if (cost < lowest) lowest = cost, best_s = delay_s;
  };
  for (double delay_s = -max_delay_s; delay_s <= max_delay_s; delay_s += delay_step_s)
    evaluate(delay_s);
  for (double step_s = 0.5 * delay_step_s; step_s >= min_delay_step_s; step_s *= 0.5) {
    const double center_s = best_s;
    evaluate(center_s - step_s), evaluate(center_s + step_s);
  }
  return best_s;
}

Eigen::Vector3d mean_offset(const std::vector<Sample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& sample : samples) sum += sample.error.head<3>();
  return sum / static_cast<double>(samples.size());
}

/// NaN without samples.
double mean(double sum, const std::vector<Sample>& samples) {
  return sum / static_cast<double>(samples.size());
}

/// [axes] RMS of the positions around a bias.
Eigen::Vector3d rms_m(const std::vector<Sample>& samples, const Eigen::Vector3d& bias_m) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const auto& sample : samples) squares += (sample.error.head<3>() - bias_m).cwiseAbs2();
  return (squares / static_cast<double>(samples.size())).cwiseSqrt();
}

std::vector<Sample> with_true_velocity(const std::vector<Sample>& samples) {
  std::vector<Sample> result;
  std::ranges::copy_if(samples, std::back_inserter(result), &Sample::has_true_velocity);
  return result;
}

/// Errors including the delay.
void measure_delayed(const std::vector<Sample>& right, BodyError& error) {
  double velocity = 0.0, causal = 0.0;
  const auto known = with_true_velocity(right);
  for (const auto& sample : known) {
    velocity += sample.error.tail<3>().squaredNorm() / 3.0;
    causal += sample.causal_velocity_error.squaredNorm() / 3.0;
  }
  error.position_rms_m = rms_m(right, Eigen::Vector3d::Zero());
  error.velocity_rms_m_per_s = std::sqrt(mean(velocity, known));
  error.causal_velocity_rms_m_per_s = std::sqrt(mean(causal, known));
}

/// Errors without the delay.
void measure_aligned(const std::vector<Sample>& right, BodyError& error) {
  double velocity = 0.0;
  const auto known = with_true_velocity(right);
  for (const auto& sample : known) velocity += sample.error.tail<3>().squaredNorm() / 3.0;
  error.impact_share = 1.0 - mean(static_cast<double>(known.size()), right);
  error.bias_m = mean_offset(right);
  error.position_spread_m = rms_m(right, error.bias_m);
  error.aligned_velocity_rms_m_per_s = std::sqrt(mean(velocity, known));
}

/// Consistency of the covariances with all errors that are not flagged as lost: bias, delay and
/// wrong positions included.
void measure_covariance(const std::vector<Sample>& samples, BodyError& error) {
  double positions_covered = 0.0, velocities_covered = 0.0, nees = 0.0;
  auto known = with_true_velocity(samples);
  std::erase_if(known, &Sample::is_lost);
  for (const auto& sample : known) {
    positions_covered += covered(sample, 0);
    velocities_covered += covered(sample, 3);
    nees += sample.error.dot(sample.covariance.ldlt().solve(sample.error)) / 6.0;
  }
  error.position_coverage = mean(positions_covered, known);
  error.velocity_coverage = mean(velocities_covered, known);
  error.nees = mean(nees, known);
}

BodyError error_of(const Labels& labels, const LabelledBody& body, const Truth& truth,
                   const Truth::Body& true_body) {
  const auto samples_at = [&](double delay_s) {
    return samples_of(labels, body, truth, true_body, delay_s);
  };
  if (samples_at(0.0).empty())
    throw data_error("no label inside the truth's clips",
                     "compare labels with the recording that they belong to");
  BodyError error, delayed;
  error.delay_s = estimate_delay(samples_at);
  measure_delayed(select_right(samples_at(0.0), delayed), error);
  measure_aligned(select_right(samples_at(error.delay_s), error), error);
  measure_covariance(samples_at(0.0), error);
  return error;
}

std::array<double, 3> numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

LabelError compare_labels_with_truth(const Labels& labels, const Truth& truth) {
  return {error_of(labels, labels.hand, truth, truth.hand),
          error_of(labels, labels.object, truth, truth.object)};
}

void to_json(nlohmann::json& json, const BodyError& error) {
  json = {{"lost_share", error.lost_share},
          {"outside_share", error.outside_share},
          {"follows_share", error.follows_share},
          {"impact_share", error.impact_share},
          {"wrong_share", error.wrong_share},
          {"wrong_unsaid_share", error.wrong_unsaid_share},
          {"bias_m", numbers(error.bias_m)},
          {"position_rms_m", numbers(error.position_rms_m)},
          {"position_spread_m", numbers(error.position_spread_m)},
          {"velocity_rms_m_per_s", error.velocity_rms_m_per_s},
          {"causal_velocity_rms_m_per_s", error.causal_velocity_rms_m_per_s},
          {"delay_s", error.delay_s},
          {"aligned_velocity_rms_m_per_s", error.aligned_velocity_rms_m_per_s},
          {"position_coverage", error.position_coverage},
          {"velocity_coverage", error.velocity_coverage},
          {"nees", error.nees}};
}

void to_json(nlohmann::json& json, const LabelError& error) {
  json = {{"hand", error.hand}, {"object", error.object}};
}

}  // namespace touchtrace::study
