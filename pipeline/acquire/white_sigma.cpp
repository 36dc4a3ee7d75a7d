#include <array>
#include <cmath>
#include <limits>

#include "engine/base/statistics.h"
#include "pipeline/acquire/track_file.h"

namespace touchtrace {
namespace {

constexpr std::size_t num_points = 4;         // of a third difference
constexpr std::size_t min_differences = 10;   // standard error of their median: 25 %
constexpr double min_relative_sigma = 1e-12;  // to the position; less is rounding of doubles
constexpr double min_axis_ratio = 0.1;        // smallest over largest standard deviation

/// Weights with which values of a quadratic at the four times sum to zero, and white errors of unit
/// variance to unit variance. Not finite if two times are equal.
std::array<double, num_points> difference_weights(const TrackPoint* points) {
  std::array<double, num_points> weights;
  double squares = 0.0;
  for (std::size_t i = 0; i < num_points; ++i) {
    weights[i] = 1.0;
    for (std::size_t j = 0; j < num_points; ++j)
      if (j != i)
        weights[i] *= (points[3].time_s - points[0].time_s) / (points[i].time_s - points[j].time_s);
    squares += weights[i] * weights[i];
  }
  for (double& weight : weights) weight /= std::sqrt(squares);
  return weights;
}

/// [axes] Third differences of the positions in units of a white error.
std::array<std::vector<double>, 3> third_differences(const Track& track) {
  std::array<std::vector<double>, 3> differences;
  for (std::size_t i = 0; i + num_points <= track.size(); ++i) {
    const auto weights = difference_weights(&track[i]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < num_points; ++k) sum += weights[k] * track[i + k].position_m;
    if (!sum.allFinite()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      differences[axis].push_back(sum[Eigen::Index(axis)]);
  }
  return differences;
}

}  // namespace

Eigen::Vector3d estimate_white_sigma(const Track& track) {
  const Eigen::Vector3d unknown =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  auto differences = third_differences(track);
  if (differences[0].size() < min_differences) return unknown;
  Eigen::Vector3d sigma_m;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sigma_m[Eigen::Index(axis)] = robust_sigma(std::move(differences[axis]));
  const double largest = sigma_m.maxCoeff();
  if (!(largest > min_relative_sigma * track.front().position_m.norm())) return unknown;
  return sigma_m.cwiseMax(min_axis_ratio * largest);
}

}  // namespace touchtrace
