#include "calib/smooth/likelihood.h"

#include <array>
#include <cmath>

#include "calib/smooth/kalman_state.h"

namespace touchtrace {
namespace {

/// Filters a track. Calls visit(step, innovations of the axes) after each point.
template <StateModel model, class Visitor>
double filter(const ScaledTrack& track, const MotionNoise& noise, const Eigen::Vector3d& gravity,
              Visitor&& visit) {
  constexpr int size = axis_state_size<model>;
  const auto prior = track.prior<model>(noise);
  const double scale = noise.measurement_scale * noise.measurement_scale;
  std::array<AxisState<size>, 3> states;
  std::array<Innovation<size>, 3> innovations;
  double cost = 0.0;
  for (std::size_t k = 0; k < track.points.size(); ++k) {
    const auto& point = track.points[k];
    const auto step = k > 0 ? prior.between(track.points[k - 1].time, point.time)
                            : prior.initial(track.position_sigma);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      states[axis] = states[axis].predict(step, gravity[i], std::exp(point.log_noise));
      innovations[axis] = states[axis].update(point.position[i], scale * point.variance[i]);
      cost += innovations[axis].cost();
    }
    visit(step, innovations);
  }
  return cost;
}

/// Derivatives of the cost of later measurements with respect to one axis' state: the gradient with
/// respect to the mean, and the matrix whose difference from the gradient's square is twice the
/// derivative with respect to the covariance.
template <int size>
struct Adjoint {
  Eigen::Matrix<double, size, 1> vector = Eigen::Matrix<double, size, 1>::Zero();
  Eigen::Matrix<double, size, size> matrix = Eigen::Matrix<double, size, size>::Zero();

  /// From after a measurement to before it: C' A C + h' h / s, C = I - gain h.
  void undo_update(const Innovation<size>& innovation) {
    const double projected = innovation.gain.dot(vector) + innovation.value / innovation.variance;
    const Eigen::Matrix<double, size, 1> column = matrix * innovation.gain;
    const double square = innovation.gain.dot(column) + 1.0 / innovation.variance;
    for (int h = 0; h < size; h += motion_size)
      vector[h] -= projected, matrix.row(h) -= column.transpose();
    for (int h = 0; h < size; h += motion_size) matrix.col(h) -= column;
    for (int i = 0; i < size; i += motion_size)
      for (int j = 0; j < size; j += motion_size) matrix(i, j) += square;
  }

  void undo_predict(const Transition<size>& step) {
    vector = (step.F.transpose() * vector).eval();
    matrix = conjugated(Eigen::Matrix<double, size, size>(step.F.transpose()), matrix);
  }
};

template <StateModel model>
LikelihoodGradient gradient_of(const ScaledTrack& track, const MotionNoise& noise,
                               const Eigen::Vector3d& gravity) {
  constexpr int size = axis_state_size<model>;
  std::vector<Transition<size>> steps;
  std::vector<std::array<Innovation<size>, 3>> innovations;
  LikelihoodGradient result;
  result.cost = filter<model>(track, noise, gravity, [&](const auto& step, const auto& of_axes) {
    steps.push_back(step), innovations.push_back(of_axes);
  });
  result.by_log_noise.resize(steps.size());
  std::array<Adjoint<size>, 3> adjoints;
  for (std::size_t k = steps.size(); k-- > 0;)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& adjoint = adjoints[axis];
      adjoint.undo_update(innovations[k][axis]);
      result.by_log_noise[k] += 0.5 * std::exp(track.points[k].log_noise) *
                                (steps[k].Q.cwiseProduct(adjoint.matrix).sum() -
                                 adjoint.vector.dot(steps[k].Q * adjoint.vector));
      adjoint.undo_predict(steps[k]);
    }
  return result;
}

}  // namespace

double negative_log_likelihood(const ScaledTrack& track, const MotionNoise& noise,
                               const Eigen::Vector3d& gravity) {
  const auto ignore = [](const auto&, const auto&) {};
  return track.events.empty() ? filter<StateModel::contact>(track, noise, gravity, ignore)
                              : filter<StateModel::with_flights>(track, noise, gravity, ignore);
}

LikelihoodGradient likelihood_gradient(const ScaledTrack& track, const MotionNoise& noise,
                                       const Eigen::Vector3d& gravity) {
  return track.events.empty() ? gradient_of<StateModel::contact>(track, noise, gravity)
                              : gradient_of<StateModel::with_flights>(track, noise, gravity);
}

}  // namespace touchtrace
