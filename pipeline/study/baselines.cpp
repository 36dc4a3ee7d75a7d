#include "pipeline/study/baselines.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/base/statistics.h"
#include "pipeline/study/metrics.h"

namespace touchtrace::study {
namespace {

constexpr int num_factors = 21;  // factors 0, 0.05, ..., 1 of the damped velocity
constexpr double ridge = 1e-3;   // per case, in units of the normalised initial states

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Cases whose target may replace that of case `i`.
std::vector<int> others(const RolloutCases& cases, int i) {
  std::vector<int> other_clips, other_starts;
  for (int j = 0; j < cases.count(); ++j) {
    if (cases.sequence[j] != cases.sequence[i]) other_clips.push_back(j);
    if (j != i) other_starts.push_back(j);
  }
  return other_clips.empty() ? other_starts : other_clips;
}

template <class T>
void append_block(std::vector<T>& to, const std::vector<T>& from, std::size_t block,
                  std::size_t size) {
  const auto first = from.begin() + static_cast<std::ptrdiff_t>(block * size);
  to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(size));
}

Baseline random_path(const RolloutCases& cases, std::uint64_t seed) {
  RandomStream random(seed, "random baseline");
  Baseline baseline{"random", {}, {}};
  for (int i = 0; i < cases.count(); ++i) {
    const auto candidates = others(cases, i);
    const auto j = static_cast<std::size_t>(candidates[random.below(candidates.size())]);
    append_block(baseline.paths, cases.batch.target, j, cases.path_size());
    append_block(baseline.weight, cases.batch.weight, j,
                 static_cast<std::size_t>(cases.batch.steps));
  }
  return baseline;
}

/// Path from an initial state; its velocity is multiplied by `factor` at each step.
std::vector<float> damped_path(const float* initial, int steps, double factor,
                               const Normalization& scaling, double step_s) {
  State state;
  std::copy_n(initial, state_size, state.begin());
  state = scaling.denormalize(state);
  std::vector<float> path;
  for (int step = 0; step < steps; ++step) {
    for (const auto& [position, velocity] :
         {std::pair(object_position, object_velocity), std::pair(hand_position, hand_velocity)})
      for (int axis = 0; axis < 3; ++axis) {
        float& speed = state[velocity.first + axis];
        speed *= static_cast<float>(factor);
        state[position.first + axis] += static_cast<float>(step_s) * speed;
      }
    const State scaled = scaling.normalize(state);
    path.insert(path.end(), scaled.begin(), scaled.end());
  }
  return path;
}

std::vector<float> damped_paths(const RolloutCases& cases, double factor,
                                const Normalization& scaling, double step_s) {
  std::vector<float> paths;
  for (int i = 0; i < cases.count(); ++i) {
    const auto path = damped_path(&cases.batch.initial_state[std::size_t(i) * state_size],
                                  cases.batch.steps, factor, scaling, step_s);
    paths.insert(paths.end(), path.begin(), path.end());
  }
  return paths;
}

double mean_error(const std::vector<float>& paths, const RolloutCases& cases) {
  return mean_until(l1_by_step(paths, cases.batch.target), cases.batch.weight,
                    cases.count() * cases.batch.steps);
}

double fit_factor(const RolloutCases& training, const Normalization& scaling, double step_s) {
  double best = 0.0, smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < num_factors; ++i) {
    const double factor = static_cast<double>(i) / (num_factors - 1);
    const double error = mean_error(damped_paths(training, factor, scaling, step_s), training);
    if (error < smallest) smallest = error, best = factor;
  }
  return best;
}

State median_state(const RolloutCases& training) {
  State state{};
  for (std::size_t d = 0; d < state_size; ++d) {
    std::vector<double> values;
    for (std::size_t i = 0; i < training.batch.weight.size(); ++i)
      if (training.batch.weight[i] > 0.0f)
        values.push_back(training.batch.target[i * state_size + d]);
    if (!values.empty()) state[d] = static_cast<float>(median(std::move(values)));
  }
  return state;
}

std::vector<float> constant_paths(const State& state, const RolloutCases& cases) {
  std::vector<float> paths;
  for (int i = 0; i < cases.count() * cases.batch.steps; ++i)
    paths.insert(paths.end(), state.begin(), state.end());
  return paths;
}

/// [cases, 13] Initial states and a constant 1.
Matrix regressors(const RolloutCases& cases) {
  Matrix rows(cases.count(), state_size + 1);
  for (int i = 0; i < cases.count(); ++i)
    for (int d = 0; d <= state_size; ++d)
      rows(i, d) = d < state_size ? cases.batch.initial_state[i * state_size + d] : 1.0;
  return rows;
}

/// [cases, steps * 12]
std::vector<float> linear_paths(const RolloutCases& cases, const RolloutCases& training) {
  const auto size = static_cast<Eigen::Index>(training.path_size());
  Matrix x = regressors(training), y(training.count(), size);
  for (int i = 0; i < training.count(); ++i) {
    const auto weight = std::span(training.batch.weight)
                            .subspan(std::size_t(i) * training.batch.steps, training.batch.steps);
    const bool trusted = std::ranges::all_of(weight, [](float w) { return w > 0.0f; });
    if (!trusted) x.row(i).setZero();
    for (Eigen::Index j = 0; j < size; ++j)
      y(i, j) = trusted ? training.batch.target[i * size + j] : 0.0f;
  }
  Matrix normal = x.transpose() * x;
  normal.diagonal().array() += ridge * training.count();
  const Matrix paths = regressors(cases) * normal.ldlt().solve(x.transpose() * y);
  return {paths.data(), paths.data() + paths.size()};
}

}  // namespace

std::vector<Baseline> make_baselines(const RolloutCases& cases, const RolloutCases& training,
                                     const Normalization& scaling, double step_s,
                                     std::uint64_t seed) {
  std::vector<Baseline> baselines{random_path(cases, seed),
                                  {"hold", damped_paths(cases, 0.0, scaling, step_s), {}}};
  if (training.count() == 0) return baselines;
  const double factor = fit_factor(training, scaling, step_s);
  baselines.push_back({"damped", damped_paths(cases, factor, scaling, step_s), {}});
  baselines.push_back({"median", constant_paths(median_state(training), cases), {}});
  baselines.push_back({"linear", linear_paths(cases, training), {}});
  return baselines;
}

}  // namespace touchtrace::study
