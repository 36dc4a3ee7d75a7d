#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Paths that need no model, to compare models with.
struct Baseline {
  std::string name;
  std::vector<float> paths;   ///< [cases, steps, 12], normalised like the cases
  std::vector<float> weight;  ///< [cases, steps], 0: the path is unknown there; empty: all 1
};

/// Baselines for `cases`:
///   random: the target of a random other case, of another clip if possible (section IV-B)
///   hold: the initial position, velocity 0
///   damped: the initial velocity, multiplied by a constant factor at each step
///   median: the median of the training states
///   linear: for each step a linear function of the initial state, by ridge regression
/// The last three are fitted to `training`, labelled cases of the same steps and scaling, and left
/// out without any. Needs two cases. `step_s`: duration of a step.
std::vector<Baseline> make_baselines(const RolloutCases& cases, const RolloutCases& training,
                                     const Normalization& scaling, double step_s,
                                     std::uint64_t seed);

}  // namespace touchtrace::study
