#include "pipeline/recording/label_check.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr double max_distance_m = 20.0;
/// Bounds of the regression of velocities on differences of positions. Labels of 16 recordings of
/// four activities at 15 to 30 Hz have 0.83 to 0.99; it falls with long intervals.
constexpr double min_velocity_ratio = 0.5, max_velocity_ratio = 2.0;
constexpr double max_interval_s = 0.1;
constexpr double min_speed_m_per_s = 0.02;  // RMS of the differences: slower motion may be noise
constexpr double max_outside_clip_s = 1.0;
constexpr double max_jump_m = 0.5;  // beyond what the velocities explain
constexpr double max_speed_m_per_s = 50.0;
constexpr double max_asymmetry = 1e-6;  // of the largest element
constexpr std::uint8_t known_quality = quality_lost | quality_follows_hand | quality_gap;

using Rows = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;

Rows rows_of(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size() / 3), 3};
}

std::optional<std::string> distance_warning(const LabelledBody& body) {
  const Rows position_m = rows_of(body.position_m);
  std::vector<double> distances_m;
  for (Eigen::Index i = 0; i < position_m.rows(); ++i)
    if (position_m.row(i).allFinite()) distances_m.push_back(position_m.row(i).norm());
  const double distance_m = median(std::move(distances_m));
  if (!(distance_m > max_distance_m)) return {};
  return fmt::format("is {:.0f} m from the camera (median): are positions in millimetres?",
                     distance_m);
}

/// Neighbouring good labels of one clip.
bool are_neighbours(const Labels& labels, const LabelledBody& body, std::size_t i) {
  const double interval_s = labels.time_s[i + 1] - labels.time_s[i];
  return labels.clip[i] == labels.clip[i + 1] && body.quality[i] == quality_good &&
         body.quality[i + 1] == quality_good && interval_s > 0.0 && interval_s <= max_interval_s;
}

/// One wrong label of many can set the scale of all errors.
std::optional<std::string> jump_warning(const Labels& labels, const LabelledBody& body) {
  const Rows position_m = rows_of(body.position_m), velocity = rows_of(body.velocity_m_per_s);
  std::size_t jumps = 0, first = 0;
  double first_m = 0.0;
  for (std::size_t at = 0; at + 1 < labels.time_s.size(); ++at) {
    if (!are_neighbours(labels, body, at)) continue;
    const auto i = static_cast<Eigen::Index>(at);
    const double interval_s = labels.time_s[at + 1] - labels.time_s[at],
                 speed = std::max(velocity.row(i).norm(), velocity.row(i + 1).norm()),
                 jump_m = (position_m.row(i + 1) - position_m.row(i)).norm();
    if (jump_m <= max_jump_m + std::min(speed, max_speed_m_per_s) * interval_s) continue;
    if (jumps++ == 0) first = at, first_m = jump_m;
  }
  if (jumps == 0) return {};
  return fmt::format(
      "jumps in {} places, first by {:.3g} m after label {}, further than its velocity explains: "
      "labels where it was lost need quality 1",
      jumps, first_m, first);
}

/// Good labels whose covariance has a negative variance or is not symmetric.
std::optional<std::string> covariance_warning(const LabelledBody& body) {
  std::size_t wrong = 0, first = 0;
  for (std::size_t i = 0; i < body.quality.size(); ++i) {
    if (body.quality[i] != quality_good) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6>> covariance(&body.covariance[36 * i]);
    const double scale = covariance.cwiseAbs().maxCoeff();
    if (covariance.diagonal().minCoeff() >= 0.0 &&
        (covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= max_asymmetry * scale)
      continue;
    if (wrong++ == 0) first = i;
  }
  if (wrong == 0) return {};
  return fmt::format(
      "has {} good labels, the first {}, whose covariance has a negative variance or is not "
      "symmetric",
      wrong, first);
}

std::optional<std::string> quality_warning(const LabelledBody& body) {
  const auto unknown = std::ranges::count_if(
      body.quality, [](std::uint8_t quality) { return (quality & ~known_quality) != 0; });
  if (unknown == 0) return {};
  return fmt::format(
      "has {} labels whose quality has other bits than 1, 2 and 4: they are not used as good ones",
      unknown);
}

/// Regression of the mean velocity of neighbouring good labels on the difference of their positions
/// over time; nullopt if the body hardly moves.
std::optional<double> velocity_ratio(const Labels& labels, const LabelledBody& body) {
  const Rows position_m = rows_of(body.position_m), velocity = rows_of(body.velocity_m_per_s);
  double products = 0.0, squares = 0.0;
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i + 1 < position_m.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!are_neighbours(labels, body, at)) continue;
    const double seconds = labels.time_s[at + 1] - labels.time_s[at];
    const Eigen::RowVector3d difference = (position_m.row(i + 1) - position_m.row(i)) / seconds,
                             mean = 0.5 * (velocity.row(i) + velocity.row(i + 1));
    if (!difference.allFinite() || !mean.allFinite()) continue;
    products += difference.dot(mean), squares += difference.squaredNorm();
    ++count;
  }
  if (!(squares > static_cast<double>(count) * min_speed_m_per_s * min_speed_m_per_s)) return {};
  return products / squares;
}

std::optional<std::string> velocity_warning(const Labels& labels, const LabelledBody& body) {
  const auto ratio = velocity_ratio(labels, body);
  if (!ratio || (*ratio >= min_velocity_ratio && *ratio <= max_velocity_ratio)) return {};
  return fmt::format(
      "has velocities that are {:.3g} times the change of its positions: are they in m/s, and of "
      "the right sign?",
      *ratio);
}

std::optional<std::string> causal_warning(const LabelledBody& body) {
  const bool moves =
      std::ranges::any_of(body.velocity_m_per_s, [](double v) { return std::abs(v) > 0.0; });
  if (!moves || body.position_m != body.causal_position_m ||
      body.velocity_m_per_s != body.causal_velocity_m_per_s)
    return {};
  return "has causal states that equal the smoothed ones: roll-outs would start from states that "
         "know later measurements";
}

std::optional<std::string> time_warning(const Labels& labels) {
  std::size_t outside = 0;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    const Clip& clip = labels.clips[static_cast<std::size_t>(labels.clip[i])];
    outside += !(labels.time_s[i] >= clip.start_s - max_outside_clip_s &&
                 labels.time_s[i] <= clip.end_s + max_outside_clip_s);
  }
  if (outside == 0) return {};
  return fmt::format(
      "{} of {} labels are outside their clips: times are seconds of the recording's clock, less "
      "its first stamp if that is Unix time",
      outside, labels.time_s.size());
}

}  // namespace

std::vector<std::string> label_warnings(const Labels& labels) {
  std::vector<std::string> warnings;
  for (const auto& [name, body] : {std::pair{"hand", &labels.hand}, {"object", &labels.object}})
    for (const auto& warning :
         {distance_warning(*body), jump_warning(labels, *body), covariance_warning(*body),
          quality_warning(*body), velocity_warning(labels, *body), causal_warning(*body)})
      if (warning) warnings.push_back(fmt::format("the {} {}", name, *warning));
  if (const auto warning = time_warning(labels)) warnings.push_back(*warning);
  return warnings;
}

}  // namespace touchtrace
